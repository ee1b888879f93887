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
  // Of the ranks below, and of those up to the own ones: the share after a shift.
  const auto score = [&](double ranks_below, double ranks_above) {
    constexpr double kShift = 2.0 * kReferenceValue;
    const double from =
        ranks_below == 0.0 ? 0.0 : cdf(standard, quantile(standard, ranks_below / count) - kShift);
    const double to =
        ranks_above == 0.0 ? 1.0 : cdf(standard, -quantile(standard, ranks_above / count) - kShift);
    return std::log((to - from) * count / own) / kShift;
  };
  return {score(below, above), score(above, below)};
}

void ControlChart::settle() {
  for (const double value : waiting_) {
    if (std::ssize(sorted_) == kLargestBaseline) break;
    sorted_.insert(std::upper_bound(sorted_.begin(), sorted_.end(), value), value);
    baseline_.add(value);
  }
  waiting_.clear();
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
    // The first value has the score 0, so that some are before the onset.
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
  const bool at_rest = upper() == 0.0 && lower() == 0.0;
  if (at_rest || std::ssize(sorted_) < kFullBaseline) settle();
  return alarm;
}

void ControlChart::restart_arms() {
  upper_ = {};
  lower_ = {};
}

}  // namespace stickslip::trend
