/// \file
/// Statistics of S − K pooled by cycle (core/analysis/pooled_slips): confidence interval, and comparison of
/// two groups of tests.
#pragma once

#include <optional>
#include <string>

#include "core/analysis/comparison.hpp"
#include "core/analysis/pooled_slips.hpp"
#include "core/analysis/replicates.hpp"

namespace stickslip::analysis {

/// 95 % confidence interval of the mean, by Student's t with test_count − 1 degrees of freedom; nullopt
/// without a standard error.
[[nodiscard]] std::optional<Interval> mean_interval(const PooledDeltaMu& pooled);

/// Result of compare_pooled().
struct PooledComparison {
  std::optional<Welch> welch;  ///< Test of the difference of the pooled means.
  std::string reason;          ///< Why there is none; set exactly then.
};

/// Compares the pooled S − K of two groups of tests, A and B. Needs in each two tests with slips that count
/// (slip_sums()), and a standard error > 0 in at least one; otherwise only `reason` is set.
[[nodiscard]] PooledComparison compare_pooled(const PooledDeltaMu& a, const PooledDeltaMu& b);

}  // namespace stickslip::analysis
