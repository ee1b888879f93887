/// \file
/// S − K pooled by cycle (core/friction/replicates) as one number of a group of tests: its interval, and two
/// such groups side by side.
#pragma once

#include <optional>
#include <string>

#include "core/friction/replicates.hpp"
#include "core/report/comparison.hpp"
#include "core/report/replicates.hpp"

namespace stickslip::report {

/// 95 % of the mean, Student's t with one degree of freedom fewer than tests; none without a standard error.
[[nodiscard]] std::optional<Interval> mean_interval(const friction::PooledDeltaMu& pooled);

struct PooledComparison {
  std::optional<Welch> welch;  ///< Of the pooled means with their standard errors.
  std::string reason;          ///< Why there is none; set exactly then.
};

/// Needs two tests of each with a slip after the first.
[[nodiscard]] PooledComparison compare_pooled(const friction::PooledDeltaMu& a,
                                              const friction::PooledDeltaMu& b);

}  // namespace stickslip::report
