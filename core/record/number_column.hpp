/// \file
/// Columns of numbers in a file that is no text and no record: vectors and parts of matrices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace stickslip::record {

struct NumberColumn {
  std::string path;  ///< "/run1/force", "/run1/table.force", "run.force".
  /// Of a member of a compound: the dataset, "/run1/table"; its name follows in `path` behind a point. Else
  /// empty.
  std::string dataset;
  std::string part;  ///< "(:,2)" and "(2,:)" of a matrix; empty for a vector.
  std::string unit;  ///< Stated beside the numbers; empty if there is none.
  std::string why;   ///< It cannot be read, "is complex"; empty if it can.
  std::uint64_t size = 0;
  bool single = false;  ///< Of 24 bits of mantissa or fewer.
};

/// More columns of one matrix are refused.
inline constexpr std::uint64_t kMostParts = 100;

/// How an array gives columns: along its longer axis.
struct ArrayShape {
  std::size_t long_axis = 0;
  std::size_t short_axis = 0;
  std::uint64_t size = 0;   ///< Numbers in a column.
  std::uint64_t count = 0;  ///< Columns.
};

/// Axes of one element do not count. \param column  takes `why` if it gives no column.
[[nodiscard]] ArrayShape shape_of(const std::vector<std::uint64_t>& axes, NumberColumn& column);

/// Appends a column for each part of an array along its shorter axis, or `column` itself with `why` if the
/// array has none that can be used.
void add_parts(NumberColumn column, const std::vector<std::uint64_t>& axes,
               std::vector<NumberColumn>& columns);

/// From 0, of a column that add_parts() gave.
[[nodiscard]] std::uint64_t part_number(const NumberColumn& column);

}  // namespace stickslip::record
