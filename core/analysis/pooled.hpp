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

struct PooledComparison {
  std::optional<Welch> welch;  ///< Test of the difference of the pooled means.
  std::string reason;          ///< Why there is none; set exactly then.
};

/// Requires of each group two tests with a slip after the first.
[[nodiscard]] PooledComparison compare_pooled(const PooledDeltaMu& a, const PooledDeltaMu& b);

}  // namespace stickslip::analysis
