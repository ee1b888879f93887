#include "core/analysis/replicates.hpp"

#include <cmath>

#include <boost/math/distributions/students_t.hpp>

namespace stickslip::analysis {

double grubbs_limit(std::size_t count) {
  const auto n = static_cast<double>(count);
  const boost::math::students_t t_distribution{n - 2.0};
  const double t = boost::math::quantile(boost::math::complement(t_distribution, kSignificance / (2.0 * n)));
  return (n - 1.0) / std::sqrt(n) * std::sqrt(t * t / (n - 2.0 + t * t));
}

Replicates describe_replicates(std::span<const double> values) {
  Replicates result;
  result.count = values.size();
  const auto n = static_cast<double>(values.size());
  // In two passes: the squares are of differences, so nothing is lost.
  for (const double value : values) result.mean += value / n;
  if (values.size() < 2) return result;
  double squares = 0.0;
  std::size_t farthest = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double difference = values[i] - result.mean;
    squares += difference * difference;
    if (std::abs(difference) > std::abs(values[farthest] - result.mean)) farthest = i;
  }
  const double s = std::sqrt(squares / (n - 1.0));
  result.standard_deviation = s;
  result.repeatability = kRepeatabilityFactor * s;
  const boost::math::students_t t_distribution{n - 1.0};
  const double k = boost::math::quantile(boost::math::complement(t_distribution, kSignificance / 2.0));
  const double half = k * s / std::sqrt(n);
  result.coverage_factor = k;
  result.mean_interval = Interval{result.mean - half, result.mean + half};
  constexpr std::size_t kFewestForGrubbs = 3;
  if (values.size() >= kFewestForGrubbs && s > 0.0) {
    const double statistic = std::abs(values[farthest] - result.mean) / s;
    const double limit = grubbs_limit(values.size());
    if (statistic > limit) result.outlier = Outlier{farthest, statistic, limit};
  }
  return result;
}

std::optional<double> pooled_standard_deviation(std::span<const Replicates> groups) {
  double squares = 0.0;
  double degrees = 0.0;
  for (const Replicates& group : groups) {
    if (!group.standard_deviation) continue;
    const double own = static_cast<double>(group.count) - 1.0;
    squares += own * *group.standard_deviation * *group.standard_deviation;
    degrees += own;
  }
  if (degrees == 0.0) return std::nullopt;
  return std::sqrt(squares / degrees);
}

}  // namespace stickslip::analysis
