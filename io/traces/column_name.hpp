/// \file
/// Headings of columns: the name, the unit beside it, and whether it is a time.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace stickslip::traces {

struct ColumnName {
  std::string text;  ///< As printed, blanks and line breaks in it one blank.
  std::string name;  ///< Without the unit.
  std::string unit;  ///< "N" of "Force (N)", "Force [N]", "Force_N", "Kraft in N"; empty if there is none.
};

/// \param units_cell  of the row of units below the headings; empty if there is none.
[[nodiscard]] ColumnName column_name(std::string_view heading, std::string_view units_cell = {});

/// Whether this is a unit of a quantity that a trace can have: "N", "(mm)", "[s]", "%" …
[[nodiscard]] bool is_unit(std::string_view text);

/// Equal for names that differ in case, in blanks, or in the form of the same Unicode characters (NFKC).
[[nodiscard]] std::string folded(std::string_view text);

/// How surely a column is a time by its name: 0 not, 1 "t" or "Cycle Time", 2 a word for time.
[[nodiscard]] int time_rank(const ColumnName& column);

/// Whether it counts scans by its name: "scan", "Sample #", "Points", "Lfd. Nr.". Only its values tell
/// surely.
[[nodiscard]] bool is_scan_counter(const ColumnName& column);

}  // namespace stickslip::traces
