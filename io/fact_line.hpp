/// \file
/// Comment lines of an exported table from which `stickslip import` makes the record again.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "core/base/text.hpp"

namespace stickslip::io {

inline constexpr std::string_view kHeaderFact = "header";  ///< record::header_to_json(), above the table.
inline constexpr std::string_view kGapFact = "gap";      ///< record::gap_to_json(), one line each, below it.
inline constexpr std::string_view kEventFact = "event";  ///< record::event_to_json()
inline constexpr std::string_view kAnchorFact = "anchor";  ///< Scan, monotonic and real time, blanks between.
inline constexpr std::string_view kScansFact = "scans";    ///< How many rows the table has.
inline constexpr std::string_view kEndFact = "end";        ///< The end without results: the last line.

/// Stands for the comma of JSON between values.
inline constexpr char kFactComma = '|';

/// "# header: {"uuid":"…"|"title":"…"}": one cell of a spreadsheet, whatever its texts hold.
/// \param json  on one line.
[[nodiscard]] inline std::string fact_line(std::string_view name, std::string_view json) {
  std::string cell;
  bool in_text = false;
  bool escaped = false;
  for (const char c : json) {
    if (in_text && (c == ',' || c == ';' || c == kFactComma)) {
      cell += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      cell += c == ',' ? kFactComma : c;
    }
    if (c == '"' && !escaped) in_text = !in_text;
    escaped = c == '\\' && !escaped;
  }
  return fmt::format("# {}: {}\n", name, base::printable(cell));
}

/// The JSON of such a line, without its name.
[[nodiscard]] inline std::string fact_json(std::string_view cell) {
  std::string json{cell};
  std::replace(json.begin(), json.end(), kFactComma, ',');
  return json;
}

}  // namespace stickslip::io
