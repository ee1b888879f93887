/// \file
/// The values and times of one trace in a foreign table.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/traces/dialect.hpp"

#include "core/base/long_column.hpp"
#include "core/base/result.hpp"

namespace stickslip::traces {

/// Numbers and headings of all columns, for messages.
[[nodiscard]] std::string listed(const Dialect& dialect);

/// Place of a column in Dialect::columns, by its heading or its number from 1. Errors: kUsage listing the
/// columns.
[[nodiscard]] base::Result<std::size_t> find_column(const Dialect& dialect, const std::string& path,
                                                    const std::string& wanted);

/// The column of times that belongs to a column of values, by its heading: the surest, and of several the
/// nearest before the values. Nothing if there is none.
[[nodiscard]] std::optional<std::size_t> time_column_of(const Dialect& dialect, std::size_t value_column);
/// The same of a column that counts scans.
[[nodiscard]] std::optional<std::size_t> counter_column_of(const Dialect& dialect, std::size_t value_column);

struct TraceTable {
  explicit TraceTable(const std::filesystem::path& scratch_folder = {})
      : value(scratch_folder), time(scratch_folder) {}

  base::LongColumn<double> value;  ///< As printed; NaN marks a hole.
  base::LongColumn<double> time;   ///< In the column's unit, less the first one; empty without such a column.
  double first_time = 0.0;         ///< What was subtracted, without date_s.
  std::optional<std::int64_t> date_s;  ///< As TimeCell, of the first row.
  bool time_in_seconds = false;        ///< Clock times and dates.
  bool time_unit_in_cells = false;     ///< "995 ms", "1.000 s": the times are in s.
  int time_decimals = 0;               ///< Most printed digits behind the decimal mark.
  std::string cell_unit;               ///< Behind each value; empty if there is none.
  std::string sha256;
  std::uint64_t size = 0;          ///< Of the file, bytes.
  std::vector<std::string> notes;  ///< What was left out: a footer, a last line that was cut. For people.

  /// Line of a row in the file, from 1.
  [[nodiscard]] std::int64_t line(std::size_t row) const;

  /// First row of each stretch of rows in consecutive lines, with its line.
  std::vector<std::pair<std::size_t, std::int64_t>> places;
};

/// Reads all rows. A row with a hole in both columns is none. Rows that hold text where numbers were are left
/// out at the end of the file, and an error before it. Errors: as TextFile; kUsage naming file:line, value
/// and remedy. \param scratch_folder  as of base::LongColumn, for the columns.
[[nodiscard]] base::Result<TraceTable> read_table(const Source& source, const Dialect& dialect,
                                                  std::size_t value_column,
                                                  std::optional<std::size_t> time_column,
                                                  const std::filesystem::path& scratch_folder = {});

}  // namespace stickslip::traces
