/// \file
/// How tests keep the limits of their batch.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/analysis/grouping.hpp"
#include "daemon/types/batch.hpp"

namespace stickslip::daemon {

/// How the tests keep a limit of their batch.
struct LimitVerdict {
  std::string quantity;  ///< Name of the result.
  ResultLimits limits;
  std::vector<std::size_t> outside;  ///< Indices among the tests.
  std::vector<std::size_t> absent;   ///< Those without such a result.

  [[nodiscard]] bool passes() const noexcept { return outside.empty() && absent.empty(); }
};

[[nodiscard]] LimitVerdict judged(const std::string& quantity, const ResultLimits& limits,
                                  std::span<const analysis::MeasuredTest> tests);

}  // namespace stickslip::daemon
