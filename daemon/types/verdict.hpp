/// \file
/// Checks tests against the limits of their batch.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/analysis/grouping.hpp"
#include "daemon/types/batch.hpp"

namespace stickslip::daemon {

/// Result of checking tests against one limit.
struct LimitVerdict {
  std::string quantity;  ///< Name of the result.
  ResultLimits limits;
  std::vector<std::size_t> outside;  ///< Indices of tests whose result is outside the limits.
  std::vector<std::size_t> absent;   ///< Indices of tests without this result.

  [[nodiscard]] bool passes() const noexcept { return outside.empty() && absent.empty(); }
};

/// Checks the result `quantity` of each test against the limits.
[[nodiscard]] LimitVerdict judged(const std::string& quantity, const ResultLimits& limits,
                                  std::span<const analysis::MeasuredTest> tests);

}  // namespace stickslip::daemon
