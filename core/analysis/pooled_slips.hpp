/// \file
/// S − K of several tests of one paper, pooled by cycle.
///
///     std::vector<SlipSums> tests;
///     for (…) tests.push_back(slip_sums(analysis.cycles()));
///     const PooledDeltaMu pooled = pool_slips(tests);
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/analysis/results.hpp"
#include "core/detect/cycle.hpp"

namespace stickslip::analysis {

/// Sums over the slips of one test that slip_sums() counts: input of pool_slips().
struct SlipSums {
  double count = 0.0;
  double sum = 0.0;         ///< Of S − K.
  double square_sum = 0.0;  ///< Of squares about the test's own mean.
  double captured_count = 0.0;
  double captured_sum = 0.0;
  double escaped_count = 0.0;  ///< Slips without kCycleCaptured, unknown ends too, but for the test's last.
};

/// Sums of one test. Slips without S − K are ignored.
/// \param cycles  rows of TestAnalysis::cycles(), by index.
/// \param with_first  includes slips with kCycleIsFirst: the first of the pull, which is often not
///        representative [Penner 1995], and those after a hold.
template <typename Cycles>
[[nodiscard]] SlipSums slip_sums(const Cycles& cycles, bool with_first = false) {
  SlipSums sums;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    const detect::Cycle& cycle = cycles[i];
    if (!std::isfinite(cycle.delta_mu) || (!with_first && (cycle.flags & detect::kCycleIsFirst) != 0))
      continue;
    // [Welford, Technometrics 4(3):419–420, 1962]
    const double off = sums.count > 0.0 ? cycle.delta_mu - sums.sum / sums.count : 0.0;
    sums.sum += cycle.delta_mu;
    sums.count += 1.0;
    sums.square_sum += off * (cycle.delta_mu - sums.sum / sums.count);
    if ((cycle.flags & detect::kCycleCaptured) != 0) {
      sums.captured_sum += cycle.delta_mu;
      sums.captured_count += 1.0;
    } else if (i + 1 < cycles.size()) {
      sums.escaped_count += 1.0;
    }
  }
  return sums;
}

/// Geometric mean of the times, s, for which the sled stuck before the slips that slip_sums() counts. Slips
/// whose time is unknown or 0 are left out; nullopt if none is left.
template <typename Cycles>
[[nodiscard]] std::optional<double> mean_stick_time_s(const Cycles& cycles, bool with_first = false) {
  double log_sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    const detect::Cycle& cycle = cycles[i];
    if (!std::isfinite(cycle.delta_mu) || !(cycle.stick_time_s > 0.0) ||
        (!with_first && (cycle.flags & detect::kCycleIsFirst) != 0))
      continue;
    log_sum += std::log(cycle.stick_time_s);
    count += 1.0;
  }
  return count > 0.0 ? std::optional{std::exp(log_sum / count)} : std::nullopt;
}

/// Result of pool_slips().
struct PooledDeltaMu {
  Estimate mean;     ///< Of S − K over the slips of all tests, each counted once.
  Estimate scatter;  ///< Standard deviation of all slips about `mean`; absent for fewer than two slips.
  std::size_t test_count = 0;     ///< Tests whose SlipSums::count is not 0.
  std::size_t slip_count = 0;     ///< Sum of SlipSums::count.
  std::size_t escaped_count = 0;  ///< Sum of SlipSums::escaped_count.
  Estimate captured_mean;         ///< Over the captured slips only; biased upwards if some slips escape.
};

/// Pools S − K over all slips, each counted once. A slip whose S − K is small for the speed escapes and ends
/// the stick-slip of its test; it must be included. The mean over captured slips only is biased upwards. The
/// mean of the tests' means is biased too, since a test cut short by an early escape weighs as much as a long
/// one. The slips up to and including the first escape are a sequence with a stopping rule, and their sum
/// over their number has no such bias [Wald, Ann. Math. Stat. 15:283–296, 1944].
///
/// The standard error is that of a ratio of sums over tests, since slips of one test share the errors of ω, γ
/// and the stick rate [Cochran, Sampling Techniques, 3rd ed. 1977, (2.46)]; it needs two tests.
[[nodiscard]] PooledDeltaMu pool_slips(std::span<const SlipSums> tests);

/// pool_slips() of the slip_sums() of each test.
[[nodiscard]] PooledDeltaMu pool_delta_mu(std::span<const std::vector<detect::Cycle>> tests,
                                          bool with_first = false);

}  // namespace stickslip::analysis
