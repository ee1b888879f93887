/// \file
/// Reduces a curve to the points that are visible.
#pragma once

#include <cstddef>
#include <vector>

#include "report/plot/figure.hpp"

namespace stickslip::plot {

/// One unbroken piece of a curve.
struct Polyline {
  std::vector<double> x{};
  std::vector<double> y{};
};

/// The pieces of the curve within the range, each with its nearest neighbour outside on either side.
/// Non-finite values, and values that are not positive on a logarithmic axis, separate pieces. If there are
/// more than two points for each of `columns` columns of the range, only the lowest and highest point of each
/// column remain, in their order, with the first and last point of each piece.
[[nodiscard]] std::vector<Polyline> visible_pieces(const Curve& curve, const AxisRange& range, bool log_x,
                                                   bool log_y, std::size_t columns);

}  // namespace stickslip::plot
