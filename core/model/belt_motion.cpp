#include "core/model/belt_motion.hpp"

#include <algorithm>
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
  if (rate < 0.0) return slope > 0.0 ? (std::sqrt(discriminant) - rate) / slope : kForEver;
  const double denominator = rate + std::sqrt(discriminant);
  return denominator > 0.0 ? 2.0 * gain / denominator : kForEver;
}

/// Whether the belt stands still or has its largest speed, and takes little time from one to the other.
/// \param end_s  after the start: the last speed lasts until then.
bool is_one_speed(const PullSpeed& plan, double end_s) noexcept {
  constexpr double kLittle = 0.1;  // Of the time at that speed.
  double changing_s = 0.0;
  double pulling_s = 0.0;
  const std::vector<SpeedPoint>& points = plan.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double v = points[i].speed_m_per_s;
    if (v != 0.0 && v != plan.largest_m_per_s()) return false;
    const bool is_last = i + 1 == points.size();
    const double duration_s = std::max(0.0, (is_last ? end_s : points[i + 1].at_s) - points[i].at_s);
    if (!is_last && points[i + 1].speed_m_per_s != v) {
      changing_s += duration_s;
    } else if (v != 0.0) {
      pulling_s += duration_s;
    }
  }
  return changing_s <= kLittle * pulling_s;
}

}  // namespace

BeltMotion::BeltMotion(PullSpeed plan, double start_s, double end_s)
    : plan_(std::move(plan)), scale_(1.0 / plan_->largest_m_per_s()), start_s_(start_s) {
  has_one_speed_ = is_one_speed(*plan_, end_s - start_s);
}

double BeltMotion::climbing_time_s(double r, double from_s, double gain) const noexcept {
  if (!plan_) return gain / r;
  // On the plan's own axis: one that was shifted and back may round to the piece before a corner.
  const double begin_s = from_s - start_s_;
  for (double t_s = begin_s;;) {
    const double until_s = plan_->steady_until_s(t_s);
    const double rate = r * scale_ * plan_->speed_m_per_s(t_s) - drift_rate_per_s_;
    const double needed_s = first_time_s(rate, r * scale_ * plan_->acceleration_m_per_s2(t_s), gain);
    if (t_s + needed_s <= until_s) return t_s - begin_s + needed_s;
    if (!std::isfinite(until_s)) return kForEver;
    gain -=
        r * scale_ * (plan_->travel_m(until_s) - plan_->travel_m(t_s)) - drift_rate_per_s_ * (until_s - t_s);
    t_s = until_s;
  }
}

std::size_t BeltMotion::pull_of(double time_s) const noexcept {
  if (!plan_) return 0;
  const std::vector<PullSpeed::Pull>& pulls = plan_->pulls();
  const auto later =
      std::upper_bound(pulls.begin() + 1, pulls.end(), time_s - start_s_,
                       [](double t_s, const PullSpeed::Pull& pull) { return t_s < pull.start_s; });
  return static_cast<std::size_t>(later - pulls.begin()) - 1;
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

bool BeltMotion::is_held_between(double before_s, double after_s) const noexcept {
  if (!plan_) return false;
  const std::size_t pull = pull_of(after_s);
  return pull != pull_of(before_s) && held_from_s(pull).has_value();
}

const BeltMotion& constant_belt() noexcept {
  static const BeltMotion belt;
  return belt;
}

}  // namespace stickslip::model
