/// \file
/// Repeated tests of one material: mean, repeatability, confidence interval, outlier.
///
///     const Replicates five = describe_replicates(coefficients);
///     five.repeatability;   // two single tests differ by less than this, 95 times of 100
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace stickslip::analysis {

/// Significance level of the intervals and tests of replicates and comparisons; two-sided.
inline constexpr double kSignificance = 0.05;

/// r = 2.8 s_r: two single results of one laboratory differ by less, 95 times of 100 (1.96 √2 = 2.77,
/// rounded) [ISO 5725-6:1994, 4.1].
inline constexpr double kRepeatabilityFactor = 2.8;

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// The value farthest from the mean, where its statistic exceeds Grubbs' limit. It stays in all statistics.
struct Outlier {
  std::size_t index = 0;   ///< Among the values given.
  double statistic = 0.0;  ///< |value − mean|/s.
  double critical = 0.0;   ///< Grubbs' limit for this number of values.
};

/// Statistics of repeated tests. A single value has count and mean alone.
struct Replicates {
  std::size_t count = 0;
  double mean = 0.0;
  std::optional<double> standard_deviation;  ///< s_r, with divisor n − 1.
  std::optional<double> repeatability;       ///< r = 2.8 s_r.
  std::optional<Interval> mean_interval;     ///< Of the mean; 95 %, Student's t [Student 1908].
  std::optional<double> coverage_factor;     ///< k of mean_interval, mean ± k s_r/√n.
  std::optional<Outlier> outlier;  ///< Absent if no value exceeds the limit, or with fewer than three.
};

/// \param values  at least one, finite.
[[nodiscard]] Replicates describe_replicates(std::span<const double> values);

/// Grubbs' two-sided limit, (n − 1)/√n √(t²/(n − 2 + t²)) with t the upper quantile at 5 %/(2n) of n − 2
/// degrees of freedom [Grubbs 1969, Technometrics 11, 1; NIST/SEMATECH e-Handbook 1.3.5.17.1].
/// \param count  ≥ 3.
[[nodiscard]] double grubbs_limit(std::size_t count);

/// √(Σ(nᵢ − 1)sᵢ²/Σ(nᵢ − 1)) over groups, each about its own mean; nullopt if no group has two values.
[[nodiscard]] std::optional<double> pooled_standard_deviation(std::span<const Replicates> groups);

}  // namespace stickslip::analysis
