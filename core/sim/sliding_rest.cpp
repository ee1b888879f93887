// How long the sled rests on the belt: SlidingMotion's closed forms.
#include <cmath>

#include "core/sim/bounded_rise.hpp"
#include "core/sim/sliding_motion.hpp"

namespace stickslip::sim {
namespace {

/// c = begun + travel, with a sign.
struct Rise {
  double sign;
  double begun;
  const BeltRate& belt;

  [[nodiscard]] double value(double t) const { return sign * (begun + belt.travel(t)); }
  [[nodiscard]] double slope(double t) const { return sign * belt.at(t); }
  [[nodiscard]] double bend(double from, double to) const { return belt.most_slope(from, to); }
};

}  // namespace

/// How far what a force of this sign has to hold is above what holds it.
struct SlidingMotion::GivingWay {
  const SlidingMotion& sled;
  double sign;
  /// Against S, with what counts at the onset; or against K with all forces: what drives the sled off.
  bool against_static;
  double offset_s;

  [[nodiscard]] double gamma() const {
    return !against_static || sled.motion_.damper_counts_at_onset ? sled.motion_.oscillator.gamma_per_s : 0.0;
  }
  [[nodiscard]] double value(double t) const {
    t += offset_s;
    // While the coupling is slack, acceleration is all that friction has to supply.
    const double spring = sled.phase_ == Phase::kRide ? 0.0 : sled.begun_.c + sled.belt_.travel(t);
    const double damper = sled.phase_ == Phase::kRide ? 0.0 : gamma() * sled.belt_.at(t);
    const Coefficients limit = sled.limits(t);
    return sign * (spring + (damper + sled.belt_.slope_at(t)) / sled.omega0_squared_) -
           (against_static ? limit.mu_s : limit.mu_k);
  }
  [[nodiscard]] double slope(double t) const {
    t += offset_s;
    const double spring = sled.phase_ == Phase::kRide ? 0.0 : sled.belt_.at(t);
    const double damper = sled.phase_ == Phase::kRide ? 0.0 : gamma() * sled.belt_.slope_at(t);
    const double growth = against_static ? sled.paper_.static_limit_slope_per_s(sled.rested_s() + t) : 0.0;
    return sign * (spring + (damper + sled.belt_.curvature_at(t)) / sled.omega0_squared_) - growth -
           sled.paper_.now().mu_k * sled.drift_.slope(t);
  }
  [[nodiscard]] double bend(double from, double to) const {
    from += offset_s;
    to += offset_s;
    const BeltRate& belt = sled.belt_;
    const double growth = against_static ? sled.paper_.static_limit_bend_per_s2(sled.rested_s() + from) : 0.0;
    return belt.most_slope(from, to) +
           (gamma() * belt.most_curvature(from) + belt.most_third(from)) / sled.omega0_squared_ + growth +
           sled.paper_.now().mu_k * sled.drift_.most_curvature(from, to);
  }
};

std::optional<double> SlidingMotion::gives_way_s(double sign, double longest_s) const {
  const double stretch_s = 1.0 / std::sqrt(omega0_squared_);
  const double rounding =
      2.0 * std::numeric_limits<double>::epsilon() * std::fmax(limits(0.0).mu_s, std::abs(begun_.c));
  GivingWay limit{*this, sign, true, 0.0};
  GivingWay drive{*this, sign, false, 0.0};
  // Both have to hold: the static limit is passed, and the forces drive the sled off the belt. The second
  // follows from the first unless a damper that does not count at the onset brakes.
  for (double t_s = 0.0; t_s < longest_s;) {
    limit.offset_s = t_s;
    const auto passed_s = bounded_rise_s(limit, longest_s - t_s, stretch_s, rounding);
    if (!passed_s) return std::nullopt;
    t_s += *passed_s;
    drive.offset_s = t_s;
    if (phase_ == Phase::kRide || drive.value(0.0) >= -rounding) return t_s;
    const auto driven_s = bounded_rise_s(drive, longest_s - t_s, stretch_s, rounding);
    if (!driven_s) return std::nullopt;
    t_s += *driven_s;
    limit.offset_s = t_s;
    if (limit.value(0.0) >= -rounding) return t_s;
  }
  return std::nullopt;
}

void SlidingMotion::plan_rest() {
  known_from_ = start_;
  const double stretch_s = 1.0 / std::sqrt(omega0_squared_);
  double first_s = walk_.left_s(start_);
  Ending ending = Ending::kSegment;
  const auto offer = [&](Ending possible, std::optional<double> t_s) {
    if (!t_s || !(*t_s < first_s)) return;
    first_s = *t_s;
    ending = possible;
  };
  if (first_s > 0.0) {
    for (const double sign : {1.0, -1.0}) offer(Ending::kGivesWay, gives_way_s(sign, first_s));
    if (phase_ == Phase::kRide) {
      offer(Ending::kTouchesCoupling, bounded_rise_s(Rise{1.0, begun_.c, belt_}, first_s, stretch_s, 0.0));
    } else if ((motion_.one_way_coupling || walk_.halts_when_unloaded()) && begun_.c >= 0.0) {
      offer(Ending::kUnloaded, bounded_rise_s(Rise{-1.0, begun_.c, belt_}, first_s, stretch_s, 0.0));
    }
  }
  end_at(ending, first_s);
}

}  // namespace stickslip::sim
