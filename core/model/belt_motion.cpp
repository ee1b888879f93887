#include "core/model/belt_motion.hpp"

#include <cmath>
#include <utility>

namespace stickslip::model {
namespace {

/// First t ≥ 0 with rate t + slope t²/2 = gain ≥ 0; infinity if there is none. Without a difference of
/// numbers that are nearly equal.
double first_time_s(double rate, double slope, double gain) noexcept {
  if (gain <= 0.0) return 0.0;
  const double discriminant = rate * rate + 2.0 * slope * gain;
  if (discriminant < 0.0) return kForEver;
  const double denominator = rate + std::sqrt(discriminant);
  return denominator > 0.0 ? 2.0 * gain / denominator : kForEver;
}

}  // namespace

BeltMotion::BeltMotion(PullSpeed plan, double start_s)
    : plan_(std::move(plan)), scale_(1.0 / plan_->largest_m_per_s()), start_s_(start_s) {}

double BeltMotion::climbing_time_s(double r, double from_s, double gain) const noexcept {
  if (!plan_) return gain / r;
  for (double t_s = from_s - start_s_;;) {
    const double time_s = t_s + start_s_;
    const double until_s = plan_->steady_until_s(t_s);
    const double needed_s = first_time_s(stick_rate(r, time_s), r * slope(time_s), gain);
    if (t_s + needed_s <= until_s) return time_s + needed_s - from_s;
    if (!std::isfinite(until_s)) return kForEver;
    gain -= climb(r, time_s, until_s - t_s);
    t_s = until_s;
  }
}

std::size_t BeltMotion::pull_of(double time_s) const noexcept {
  std::size_t pull = 0;
  if (!plan_) return pull;
  while (pull + 1 < plan_->pulls().size() && plan_->pulls()[pull + 1].start_s <= time_s - start_s_) ++pull;
  return pull;
}

double BeltMotion::pull_end_s(std::size_t pull) const noexcept {
  return plan_ ? plan_->pulls()[pull].end_s + start_s_ : kForEver;
}

double BeltMotion::pull_start_s(std::size_t pull) const noexcept {
  return plan_ && pull > 0 ? plan_->pulls()[pull].start_s + start_s_ : -kForEver;
}

std::optional<double> BeltMotion::held_from_s(std::size_t pull) const noexcept {
  if (!plan_ || pull == 0) return std::nullopt;
  const double stop_s = pull_end_s(pull - 1);
  // A way of rounding is none: 1e-9 of the way at full speed.
  constexpr double kNoWay = 1e-9;
  const double rest_s = pull_start_s(pull) - stop_s;
  return std::abs(way_s(stop_s, rest_s)) <= kNoWay * rest_s ? std::optional{stop_s} : std::nullopt;
}

const BeltMotion& constant_belt() noexcept {
  static const BeltMotion belt;
  return belt;
}

}  // namespace stickslip::model
