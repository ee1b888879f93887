/// \file
/// Several tests of one paper as one: S − K pooled by cycle.
///
///     std::vector<SlipSums> tests;
///     for (…) tests.push_back(slip_sums(analysis.cycles()));
///     const PooledDeltaMu pooled = pool_slips(tests);
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "core/analysis/results.hpp"
#include "core/detect/cycle.hpp"

namespace stickslip::analysis {

/// What pooling needs to know of one test: sums over its slips with an S − K.
struct SlipSums {
  double count = 0.0;
  double sum = 0.0;         ///< Of S − K.
  double square_sum = 0.0;  ///< Of squares about the test's own mean.
  double captured_count = 0.0;
  double captured_sum = 0.0;
  double escaped_count = 0.0;  ///< Not captured, but for the last slip: what that did nobody has seen.
};

/// \param cycles  rows of TestAnalysis::cycles(), by index; slips without S − K do not count. \param
/// with_first  the first slip of the pull counts: it is often not representative [Penner 1995].
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

struct PooledDeltaMu {
  Estimate mean;                  ///< Over the slips of all tests, each counted once.
  Estimate scatter;               ///< Standard deviation from slip to slip.
  std::size_t test_count = 0;     ///< Tests with such a slip.
  std::size_t slip_count = 0;     ///< Slips with an S − K.
  std::size_t escaped_count = 0;  ///< Those among them that did not end in sticking.
  Estimate captured_mean;         ///< Over the slips that stuck again alone: biased where some escape.
};

/// A slip whose S − K is small against the speed does not stick again and ends its test's stick-slip: it must
/// be counted, and by cycle. Slips that stuck again alone are chosen for a large S − K; a mean of the tests'
/// means gives the tests that an early escape cut short the weight of long ones. Slips up to and with the
/// first escape are a sequence that stops by what it has shown so far, so that their sum over their number
/// has no such bias [Wald, Ann. Math. Stat. 15:283–296, 1944].
///
/// The standard error is that of a ratio of sums over tests, since slips of one test share the errors of ω, γ
/// and the stick rate [Cochran, Sampling Techniques, 3rd ed. 1977, (2.46)]; it needs two tests.
[[nodiscard]] PooledDeltaMu pool_slips(std::span<const SlipSums> tests);

/// The same from the cycles of each test, without their first slips unless `with_first`.
[[nodiscard]] PooledDeltaMu pool_delta_mu(std::span<const std::vector<detect::Cycle>> tests,
                                          bool with_first = false);

}  // namespace stickslip::analysis
