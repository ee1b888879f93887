/// \file
/// Belt speed over the time of a trace, and the rate at which the force rises while the sled sticks.
///
///     BeltMotion belt;                                  // one speed throughout
///     BeltMotion ramp{plan, start_s};                   // a plan that began at start_s of the trace
///     const double rate = ramp.stick_rate(r, time_s);   // c′ of a stick, r that at the plan's largest speed
///
/// Stick: c′(t) = r p(t), with p the speed relative to the plan's largest. The equation of slip, c″ + γ c′ +
/// ω₀² (c − K) = 0, does not contain the belt: in the laboratory's frame spring and damper act between sled
/// and load cell, and K does not depend on the speed. A changing speed enters in three places, each exact
/// here: the rate at the onset is r p; capture is where c′ meets r p(t); and the friction at the onset is c +
/// a/g, since it also accelerates the sled with the belt (acceleration a).
#pragma once

#include <cstddef>
#include <optional>

#include "core/model/pull_speed.hpp"

namespace stickslip::model {

class BeltMotion {
 public:
  /// Constant belt, p = 1.
  BeltMotion() = default;
  /// \param start_s  time of the trace at which the belt started. \param end_s  of the trace; only
  /// has_one_speed() asks for it. If it is earlier than the last point of the plan, that point counts.
  BeltMotion(PullSpeed plan, double start_s, double end_s = -kForEver);

  /// Has no plan. A plan of one speed is not constant: the belt rests before it.
  [[nodiscard]] bool is_constant() const noexcept { return !plan_; }
  /// Whether the belt only pulls at one speed, rests, starts and stops, and its starts and stops take at most
  /// a tenth of the time at that speed until the end of the trace. True if is_constant().
  [[nodiscard]] bool has_one_speed() const noexcept { return has_one_speed_; }
  /// The speed as planned, as measured, or with the holds found, over the time since start_s(). Requires
  /// !is_constant().
  [[nodiscard]] const PullSpeed& plan() const noexcept { return *plan_; }
  [[nodiscard]] double start_s() const noexcept { return start_s_; }

  /// Tells the belt that a drift was subtracted from the trace: in a stick c then rises at r p − drift rate.
  /// Has no effect on a constant belt, where the fitted r absorbs the drift.
  void take_off_drift(double rate_per_s) noexcept { drift_rate_per_s_ = rate_per_s; }

  /// p: speed over the plan's largest speed; 1 on a constant belt, below zero where the carriage returns.
  [[nodiscard]] double relative(double time_s) const noexcept {
    return plan_ ? plan_->speed_m_per_s(time_s - start_s_) * scale_ : 1.0;
  }
  /// p′, 1/s
  [[nodiscard]] double slope(double time_s) const noexcept {
    return plan_ ? plan_->acceleration_m_per_s2(time_s - start_s_) * scale_ : 0.0;
  }
  /// ∫p dt over [from_s, from_s + duration_s], in seconds. The duration may be negative.
  [[nodiscard]] double way_s(double from_s, double duration_s) const noexcept {
    if (!plan_) return duration_s;
    const double t_s = from_s - start_s_;
    return (plan_->travel_m(t_s + duration_s) - plan_->travel_m(t_s)) * scale_;
  }

  // In the following, r is the stick rate at the plan's largest speed, 1/s.
  /// c′ of a stick at a time, 1/s: r p less the drift rate.
  [[nodiscard]] double stick_rate(double r, double time_s) const noexcept {
    return plan_ ? r * relative(time_s) - drift_rate_per_s_ : r;
  }
  /// Rise of c during a stick of duration_s that begins at from_s.
  [[nodiscard]] double climb(double r, double from_s, double duration_s) const noexcept {
    return plan_ ? r * way_s(from_s, duration_s) - drift_rate_per_s_ * duration_s : r * duration_s;
  }
  /// Inverse of climb(): shortest duration, s, of a stick from from_s in which c rises by `gain`, ≥ 0;
  /// infinity if c never does. \param r  > 0.
  [[nodiscard]] double climbing_time_s(double r, double from_s, double gain) const noexcept;
  /// a/g = r p′/ω₀²: the part of the friction at the onset that accelerates the sled with the belt.
  [[nodiscard]] double acceleration_share(double r, double omega0_squared, double time_s) const noexcept {
    return plan_ ? r * slope(time_s) / omega0_squared : 0.0;
  }

  /// Index of the latest pull of the plan that has begun; 0 before the first, and if is_constant().
  [[nodiscard]] std::size_t pull_of(double time_s) const noexcept;
  // In the following, a pull is an index into plan().pulls(), as from pull_of().
  /// End of a pull on the trace's time axis; infinity if it never stops, and if is_constant().
  [[nodiscard]] double pull_end_s(std::size_t pull) const noexcept;
  /// Start of a pull on the trace's time axis; −infinity for pull 0.
  [[nodiscard]] double pull_start_s(std::size_t pull) const noexcept;
  /// Time of the trace at which the belt stopped before a pull, if it has only stood still since: the sled
  /// rested under load. Nullopt for pull 0, if the belt went back in between, and if is_constant().
  [[nodiscard]] std::optional<double> held_from_s(std::size_t pull) const noexcept;
  /// Whether the two times lie in different pulls, and the belt only stood still right before the later pull.
  [[nodiscard]] bool is_held_between(double before_s, double after_s) const noexcept;

 private:
  std::optional<PullSpeed> plan_;
  double scale_ = 1.0;  ///< One over the largest speed.
  bool has_one_speed_ = true;
  double start_s_ = 0.0;
  double drift_rate_per_s_ = 0.0;
};

/// A constant belt that lives as long as the program.
[[nodiscard]] const BeltMotion& constant_belt() noexcept;

}  // namespace stickslip::model
