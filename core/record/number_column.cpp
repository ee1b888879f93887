#include "core/record/number_column.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

namespace stickslip::record {

ArrayShape shape_of(const std::vector<std::uint64_t>& axes, NumberColumn& column) {
  std::vector<std::size_t> longer;  // Than 1.
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    if (axes[axis] == 0) {
      column.why = "is empty";
      return {};
    }
    if (axes[axis] > 1) longer.push_back(axis);
  }
  if (longer.empty()) {
    column.why = "is one number";
    return {};
  }
  if (longer.size() == 1) return {longer[0], longer[0], axes[longer[0]], 1};
  if (longer.size() > 2) {
    column.why = fmt::format("has {} dimensions", longer.size());
    return {};
  }
  if (axes[longer[1]] > axes[longer[0]]) std::swap(longer[0], longer[1]);
  const ArrayShape shape{longer[0], longer[1], axes[longer[0]], axes[longer[1]]};
  if (shape.count > kMostParts) {
    column.why =
        fmt::format("has {} by {} numbers, more than {} columns", axes[std::min(longer[0], longer[1])],
                    axes[std::max(longer[0], longer[1])], kMostParts);
  }
  return shape;
}

void add_parts(NumberColumn column, const std::vector<std::uint64_t>& axes,
               std::vector<NumberColumn>& columns) {
  const ArrayShape shape = shape_of(axes, column);
  if (!column.why.empty()) {
    columns.push_back(std::move(column));
    return;
  }
  column.size = shape.size;
  for (std::uint64_t i = 1; i <= shape.count; ++i) {
    if (shape.count > 1)
      column.part = shape.short_axis > shape.long_axis ? fmt::format("(:,{})", i) : fmt::format("({},:)", i);
    columns.push_back(column);
  }
}

std::uint64_t part_number(const NumberColumn& column) {
  const std::size_t at = column.part.find_first_of("0123456789");
  if (at == std::string::npos) return 0;
  std::uint64_t number = 1;
  std::from_chars(column.part.data() + at, column.part.data() + column.part.size(), number);
  return number - 1;
}

}  // namespace stickslip::record
