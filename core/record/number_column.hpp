/// \file
/// Columns of numbers in HDF5 and MATLAB files of other programs: vectors, and rows or columns of matrices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace stickslip::record {

/// Description of a column, or of something in the file that is none. It does not hold the numbers.
struct NumberColumn {
  std::string path;  ///< "/run1/force", "/run1/table.force", "run.force".
  /// For a member of an HDF5 compound: the dataset, "/run1/table"; in `path` a point and the member's name
  /// follow. Else empty.
  std::string dataset;
  std::string part;        ///< Column "(:,2)" or row "(2,:)" of a matrix, from 1; empty for a vector.
  std::string unit;        ///< Stated beside the numbers; empty if there is none.
  std::string why;         ///< Why it cannot be read, such as "is complex"; empty if it can.
  std::uint64_t size = 0;  ///< Numbers in the column; 0 if it cannot be read.
  bool single = false;     ///< The numbers are floating point of at most 32 bits; false for integers.
};

/// Most columns of one matrix; a matrix with more is refused.
inline constexpr std::uint64_t kMostParts = 100;

/// Columns of an array, which lie along the longer of its two axes; of equal ones, along the first. Axes of
/// one element do not count. A vector is one column; its two axes here are the same.
struct ArrayShape {
  std::size_t long_axis = 0;   ///< Index of the axis in the array.
  std::size_t short_axis = 0;  ///< Index of the axis in the array.
  std::uint64_t size = 0;      ///< Numbers in a column.
  std::uint64_t count = 0;     ///< Columns.
};

/// Columns of an array with these numbers of elements along its axes.
/// \param column  its `why` is set if the array gives none: if it is empty, is one number, has more than two
///        axes, or more than kMostParts columns. The shape then has no meaning.
[[nodiscard]] ArrayShape shape_of(const std::vector<std::uint64_t>& axes, NumberColumn& column);

/// Appends each column of an array: `column` with size and part. Appends `column` once, with its reason in
/// `why`, if shape_of() refuses the array.
/// \param column  its `why` must be empty.
void add_parts(NumberColumn column, const std::vector<std::uint64_t>& axes,
               std::vector<NumberColumn>& columns);

/// Number of a column of add_parts() within its matrix, from 0; 0 for a vector.
[[nodiscard]] std::uint64_t part_number(const NumberColumn& column);

}  // namespace stickslip::record
