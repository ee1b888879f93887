/// \file
/// A cell of a time column, in seconds.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "io/traces/cell.hpp"

namespace stickslip::traces {

struct TimeCell {
  double value = 0.0;  ///< In the column's unit; of a clock or a date in s.
  int decimals = 0;    ///< Printed digits behind the decimal mark.
  /// Whole seconds since 1970, UTC, that `value` counts from: dates alone. Text without an offset is taken as
  /// UTC.
  std::optional<std::int64_t> date_s;
  bool in_seconds = false;  ///< "00:01:02.5" and dates have their unit in them.
  /// Of the cell's text: a date that is not read, "11/25/2026" or "25.11.26", as the order of its parts
  /// is not known.
  std::string_view unclear_date{};
};

/// A number, "hh:mm:ss.fff", "hh:mm:ss:fff", "mm:ss.f", "hh:mm:ss PM", or a date and time of ISO 8601
/// ("2026-11-25T12:00:00.5Z"), with points ("25.11.2026 12:00:00") or an English month ("25-Nov-2026
/// 12:00:00"). Of a date with slashes that has its year last, and of one in numbers with a year of two
/// digits, the clock alone counts: TimeCell::unclear_date. \return nothing for other text.
[[nodiscard]] std::optional<TimeCell> read_time_cell(std::string_view text, char decimal);
/// The same. \param cell  what read_cell() says of the text.
[[nodiscard]] std::optional<TimeCell> read_time_cell(std::string_view text, const Cell& cell, char decimal);

}  // namespace stickslip::traces
