/// \file
/// The belt as the fits see it: how the force rises while the sled sticks to it.
///
///     BeltCourse belt;                                  // one speed throughout
///     BeltCourse ramp{plan, start_s};                   // a plan that began at start_s of the trace
///     const double rate = ramp.stick_rate(r, time_s);   // c′ of a stick, r that at the plan's largest speed
///
/// Stick: c′(t) = r p(t), p the speed relative to the plan's largest. The slip's own equation
/// c″ + γ c′ + ω₀² (c − K) = 0 does not contain the belt: in the laboratory's frame spring and damper act
/// between sled and load cell, and K does not depend on the speed. So a changing speed enters in three
/// places, all exact here: the rate c′ at the onset is r p there, the sled is captured when c′ meets r p(t),
/// and what friction gives at the onset is c + a/g, since it takes the sled along with the belt's
/// acceleration a.
#pragma once

#include <cstddef>
#include <optional>

#include "core/model/pull_speed.hpp"

namespace stickslip::model {

class BeltCourse {
 public:
  /// One speed throughout, p = 1.
  BeltCourse() = default;
  /// \param start_s  time of the trace at which the belt started.
  BeltCourse(PullSpeed plan, double start_s);

  [[nodiscard]] bool is_constant() const noexcept { return !plan_; }
  /// What is known of the speed; only unless is_constant().
  [[nodiscard]] const PullSpeed& plan() const noexcept { return *plan_; }
  [[nodiscard]] double start_s() const noexcept { return start_s_; }

  /// In a trace from which a drift has been taken off, sticks rise by it less. With one speed throughout r is
  /// found less by it; with a plan it has to be said.
  void take_off_drift(double rate_per_s) noexcept { drift_rate_per_s_ = rate_per_s; }

  /// p, 1 at the plan's largest speed.
  [[nodiscard]] double relative(double time_s) const noexcept {
    return plan_ ? plan_->speed_m_per_s(time_s - start_s_) * scale_ : 1.0;
  }
  /// p′, 1/s
  [[nodiscard]] double slope(double time_s) const noexcept {
    return plan_ ? plan_->acceleration_m_per_s2(time_s - start_s_) * scale_ : 0.0;
  }
  /// ∫p over [from_s, from_s + duration_s], s; the duration may be negative.
  [[nodiscard]] double way_s(double from_s, double duration_s) const noexcept {
    if (!plan_) return duration_s;
    const double t_s = from_s - start_s_;
    return (plan_->travel_m(t_s + duration_s) - plan_->travel_m(t_s)) * scale_;
  }

  // In terms of r, the stick rate at the plan's largest speed; 1/s.
  [[nodiscard]] double stick_rate(double r, double time_s) const noexcept {
    return plan_ ? r * relative(time_s) - drift_rate_per_s_ : r;
  }
  /// What c gains while the sled sticks from from_s on for so long.
  [[nodiscard]] double climb(double r, double from_s, double duration_s) const noexcept {
    return plan_ ? r * way_s(from_s, duration_s) - drift_rate_per_s_ * duration_s : r * duration_s;
  }
  /// How long it takes to gain that, ≥ 0; infinity if it never does.
  [[nodiscard]] double climbing_time_s(double r, double from_s, double gain) const noexcept;
  /// a/g = r p′/ω₀²: the part of S that takes the sled along with an accelerating belt.
  [[nodiscard]] double acceleration_share(double r, double omega0_squared, double time_s) const noexcept {
    return plan_ ? r * slope(time_s) / omega0_squared : 0.0;
  }

  /// Which pull of the plan a time belongs to: the latest that has begun; 0 with one speed throughout.
  [[nodiscard]] std::size_t pull_of(double time_s) const noexcept;
  /// When that pull ends; infinity with one speed throughout.
  [[nodiscard]] double pull_end_s(std::size_t pull) const noexcept;
  /// When it begins; −infinity for the first.
  [[nodiscard]] double pull_start_s(std::size_t pull) const noexcept;

 private:
  std::optional<PullSpeed> plan_;
  double scale_ = 1.0;  ///< One over the largest speed.
  double start_s_ = 0.0;
  double drift_rate_per_s_ = 0.0;
};

/// One speed throughout.
[[nodiscard]] const BeltCourse& constant_belt() noexcept;

}  // namespace stickslip::model
