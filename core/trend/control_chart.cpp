#include "core/trend/control_chart.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <boost/math/distributions/normal.hpp>

#include "core/base/contract.hpp"

namespace stickslip::trend {

double one_sided_run_length(double shift, double k, double h) {
  STICKSLIP_EXPECTS(k > 0.0 && h > 0.0);
  // Mean overshoot of a normal walk over a barrier, for both ends [Siegmund 1985].
  constexpr double kOvershoot = 1.166;
  const double drift = shift - k;
  const double b = h + kOvershoot;
  if (std::abs(drift) < 1e-6) return b * b;  // The limit of the formula; its terms cancel near 0.
  return (std::exp(-2.0 * drift * b) + 2.0 * drift * b - 1.0) / (2.0 * drift * drift);
}

double run_length(double shift, double k, double h) {
  return 1.0 / (1.0 / one_sided_run_length(shift, k, h) + 1.0 / one_sided_run_length(-shift, k, h));
}

bool ControlChart::Arm::add(double score, double value, double spread) {
  if (height == 0.0) standard_deviation = spread;
  height = std::max(0.0, height + score);
  if (height > 0.0) {
    since.add(value);
  } else {
    since = {};
  }
  return height > kDecisionInterval;
}

ControlChart::Scores ControlChart::scores(double value) const {
  const auto [first, end] = std::equal_range(sorted_.begin(), sorted_.end(), value);
  const auto count = static_cast<double>(sorted_.size() + 1);
  const auto below = static_cast<double>(std::distance(sorted_.begin(), first));
  const auto above = static_cast<double>(std::distance(end, sorted_.end()));
  const double own = count - below - above;
  const boost::math::normal standard;
  // One rank is as good as its middle. The whole cell would make more of the ends of a short baseline.
  if (own == 1.0) {
    const double z = quantile(standard, (below + 0.5) / count);
    return {z - kReferenceValue, -z - kReferenceValue};
  }
  // The cell's share after the shift, over its share before. Half a rank at each end is left to values that
  // have not been seen: else equal values without any other would say nothing, and lower no arm.
  const auto score = [&](double ranks_below, double ranks_above) {
    constexpr double kShift = 2.0 * kReferenceValue;
    constexpr double kUnseen = 0.5;
    const double lower = std::max(ranks_below, kUnseen) / count;
    const double upper = std::max(ranks_above, kUnseen) / count;
    const double from = cdf(standard, quantile(standard, lower) - kShift);
    const double to = cdf(standard, -quantile(standard, upper) - kShift);
    return std::log((to - from) / (1.0 - upper - lower)) / kShift;
  };
  return {score(below, above), score(above, below)};
}

void ControlChart::settle(std::int64_t left) {
  while (std::ssize(waiting_) > left) {
    const double value = waiting_.front();
    waiting_.pop_front();
    if (std::ssize(sorted_) == kLargestBaseline) continue;
    sorted_.insert(std::upper_bound(sorted_.begin(), sorted_.end(), value), value);
    baseline_.add(value);
  }
}

std::optional<ChartAlarm> ControlChart::add(double value) {
  STICKSLIP_EXPECTS(std::isfinite(value));
  outside_ =
      std::ssize(sorted_) >= kFewestForLimits && std::abs(value - mean()) > kShewhart * standard_deviation();
  const Scores score = scores(value);
  all_.add(value);
  const bool rises = upper_.add(score.rising, value, standard_deviation());
  const bool falls = lower_.add(score.falling, value, standard_deviation());
  std::optional<ChartAlarm> alarm;
  if (rises || falls) {
    const Arm& arm = rises ? upper_ : lower_;
    const signal::RunningMean& since = arm.since;
    // The first value lowers both arms, so that some values are before the onset.
    const double before = (all_.mean * all_.count - since.mean * since.count) / (all_.count - since.count);
    alarm = {rises,
             count_ + 1 - static_cast<std::int64_t>(since.count),
             count_,
             arm.height,
             since.mean - before,
             arm.standard_deviation};
    restart_arms();
  }
  ++count_;
  waiting_.push_back(value);
  settle(std::ssize(sorted_) < kFullBaseline ? 0 : excursion_count());
  return alarm;
}

void ControlChart::restart_arms() {
  upper_ = {};
  lower_ = {};
}

}  // namespace stickslip::trend
