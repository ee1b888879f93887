/// \file
/// How a file writes its table: recognised from its beginning before any value is read.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/traces/cell.hpp"
#include "io/traces/column_name.hpp"
#include "io/traces/row_reader.hpp"
#include "io/traces/text_file.hpp"

#include "core/base/result.hpp"

namespace stickslip::traces {

class NumberFile;

/// What the user states; the rest is recognised.
struct DialectOptions {
  std::optional<Encoding> encoding;
  std::optional<char> separator;
  std::optional<char> decimal;  ///< '.' or ','.
  std::int64_t skip = 0;        ///< Lines at the beginning that are no part of the table.
};

/// The same as options of `stickslip import`, each with a blank in front.
[[nodiscard]] std::string options_text(const DialectOptions& options);

struct Dialect {
  Encoding encoding = Encoding::kUtf8;
  char separator = ',';
  char decimal = '.';
  std::int64_t header_line = 0;  ///< From 1; 0: the file has no heading.
  std::int64_t units_line = 0;   ///< Of a row of units below it; 0: none.
  /// Fields of further rows of the heading, four at most, without blanks at their ends.
  std::vector<std::vector<std::string>> rows_below_heading;
  std::int64_t first_row_line = 0;
  std::int64_t unclear_heading_line = 0;  ///< Of a heading whose names cannot be told apart; 0: none.
  bool decimal_is_stated = false;         ///< By the user.
  std::vector<ColumnName> columns;        ///< As many as a row has fields; texts are empty without a heading.
  std::vector<bool> numeric;              ///< Columns that hold numbers alone; others may hold any text.
  std::vector<bool> empty;                ///< Columns in which no row has anything.
  std::vector<bool> clock;                ///< Columns of clock times and dates, which are not numeric.
  std::vector<bool> sparse;               ///< Columns of text in which fewer than half of the rows have any.
  std::vector<bool> constant;             ///< Columns in which all rows looked at have the same text.
  std::vector<std::string> labels;        ///< "Force" where each cell reads "Force:0.12"; else empty.
  std::shared_ptr<NumberFile> numbers;  ///< Of a file that is no text, instead of all but columns; else null.

  /// The field as a cell holds it: without its label.
  [[nodiscard]] std::string_view content(std::size_t column, std::string_view field) const;
  /// Reads the fields of the numeric columns and those behind the last column; cells of other columns are
  /// empty. \param cells  get one more for each field.
  void read_cells(const std::vector<std::string_view>& fields, std::vector<Cell>& cells) const;
  /// Whether these fields are one row of scans: a number or a hole in each numeric column, one number at
  /// least. \param cells  from read_cells().
  [[nodiscard]] bool is_row(std::span<const Cell> cells) const;
  /// The column in which a row of scans begins with a word where most have nothing or a clock time: at the
  /// end of the table, below none that has a word there, it is one of statistics, "Mean;0.50;2.41".
  [[nodiscard]] std::optional<std::size_t> label_column(const std::vector<std::string_view>& fields) const;
  /// Two lines: what was recognised. \param value  the column that is read, where one is.
  [[nodiscard]] std::string text(std::optional<std::size_t> value = std::nullopt) const;
};

/// Whether a line is a comment or blank, and no part of the table.
[[nodiscard]] bool is_no_row(std::string_view line);

/// Errors: as TextFile; kUsage if there is no table, or if two readings are possible: both are shown with the
/// option that decides.
[[nodiscard]] base::Result<Dialect> recognise(const Source& source, const DialectOptions& options);

}  // namespace stickslip::traces
