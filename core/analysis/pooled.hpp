/// \file
/// S − K pooled by cycle (core/analysis/pooled_slips) as one number of a group of tests: its interval, and
/// two such groups side by side.
#pragma once

#include <optional>
#include <string>

#include "core/analysis/comparison.hpp"
#include "core/analysis/pooled_slips.hpp"
#include "core/analysis/replicates.hpp"

namespace stickslip::analysis {

/// 95 % of the mean, Student's t with one degree of freedom fewer than tests; none without a standard error.
[[nodiscard]] std::optional<Interval> mean_interval(const PooledDeltaMu& pooled);

struct PooledComparison {
  std::optional<Welch> welch;  ///< Of the pooled means with their standard errors.
  std::string reason;          ///< Why there is none; set exactly then.
};

/// Needs two tests of each with a slip after the first.
[[nodiscard]] PooledComparison compare_pooled(const PooledDeltaMu& a, const PooledDeltaMu& b);

}  // namespace stickslip::analysis
