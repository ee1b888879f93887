/// \file
/// Headings within a table: of tables that were joined, the same again or another one.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/traces/cell.hpp"
#include "io/traces/column_name.hpp"
#include "io/traces/dialect.hpp"

namespace stickslip::traces {

/// Compares rows with the heading of a file.
class RepeatedHeading {
 public:
  enum class Again { kNo, kHeading, kOnlyUnits };

  /// \param dialect  must outlive this.
  explicit RepeatedHeading(const Dialect& dialect);

  /// Whether a row is the heading again, or another row of it: its units, or one of rows_below_heading.
  /// \param cells  of the row, by Dialect::read_cells(). \param below_heading  no scan stands between the
  /// heading and this row.
  [[nodiscard]] Again again(const std::vector<std::string_view>& fields, std::span<const Cell> cells,
                            bool below_heading) const;
  /// What differs in a row of words that is another heading, as it has a name of the first one or units
  /// alone; empty of other rows.
  [[nodiscard]] std::string change(const std::vector<std::string_view>& fields) const;

 private:
  /// Whether a heading names this column, with the unit that the first heading has in this row, or that the
  /// column has. Names of other columns that differ in case alone are told by it.
  [[nodiscard]] bool is_same(const ColumnName& name, std::size_t column) const;
  [[nodiscard]] bool is_same_unit(const std::string& unit, std::size_t column) const;

  const Dialect& dialect_;
  std::vector<std::string> folded_names_;  ///< Of the columns.
};

}  // namespace stickslip::traces
