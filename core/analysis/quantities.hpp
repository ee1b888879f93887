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
  std::string_view title;  ///< Short, for sentences.
  std::string_view unit;   ///< SI, "1" for a ratio.
  int decimals;            ///< In tables.
  Estimate analysis::TestResults::*estimate;
  std::string_view label;    ///< For tables at a terminal: with the symbol.
  std::string_view in_full;  ///< For pages: with the name in the standards.
  bool of_model;  ///< A quantity of the two-parameter model; static, kinetic and amplitude are not.
};

inline constexpr std::size_t kQuantityCount = 8;

/// The quantities in the order of tables.
[[nodiscard]] const std::array<Quantity, kQuantityCount>& quantities() noexcept;

}  // namespace stickslip::analysis
