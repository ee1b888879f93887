/// \file
/// One cell of a foreign table: number, hole or text.
#pragma once

#include <string>
#include <string_view>

namespace stickslip::traces {

enum class CellKind {
  kEmpty,
  kNumber,
  kHole,  ///< A word for a missing value: NaN, #N/A, #DIV/0!, ---, OVLD …
  kText,
};

struct Cell {
  CellKind kind = CellKind::kEmpty;
  double value = 0.0;  ///< Of a number, finite.
  int decimals = 0;    ///< Printed digits behind the decimal mark, less the exponent.
  /// "6,944": one mark that is not the decimal one, three digits behind it and no decimals, so that it may be
  /// a decimal mark all the same.
  bool one_group = false;
  std::string_view unit;  ///< What stands behind the number, such as "N"; a part of the text.
};

/// Reads a cell. Blanks at the ends, a plus sign, the minus sign of Unicode (U+2212) and marks of thousands
/// (the one of '.' and ',' that is not the decimal mark, a blank or an apostrophe, in groups of three digits)
/// are understood.
/// \param decimal  the decimal mark, '.' or ','.
[[nodiscard]] Cell read_cell(std::string_view text, char decimal);

[[nodiscard]] constexpr bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }

/// Without blanks at the ends; those of Unicode count.
[[nodiscard]] std::string_view trimmed(std::string_view text) noexcept;

}  // namespace stickslip::traces
