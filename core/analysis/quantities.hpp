/// \file
/// The results of a test that reports compare between tests.
#pragma once

#include <array>
#include <string_view>

#include "core/analysis/results.hpp"

namespace stickslip::analysis {

/// One compared result: name, title, unit and member of TestResults.
struct Quantity {
  std::string_view name;   ///< As in the record.
  std::string_view title;  ///< Short, for tables.
  std::string_view unit;   ///< SI, "1" for a ratio.
  int decimals;            ///< In tables.
  Estimate analysis::TestResults::*estimate;
};

inline constexpr std::size_t kQuantityCount = 8;

/// The quantities in the order of tables.
[[nodiscard]] const std::array<Quantity, kQuantityCount>& quantities() noexcept;

}  // namespace stickslip::analysis
