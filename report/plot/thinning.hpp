/// \file
/// Points of a line that can be seen.
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

/// The curve within the range, with the nearest neighbour on each side, broken where it is not finite or not
/// positive on a log axis. More points than two for each of `columns` columns of the range are thinned to the
/// lowest and highest of each column, in their order, the first and last point of each piece kept.
[[nodiscard]] std::vector<Polyline> visible_pieces(const Curve& curve, const AxisRange& range, bool log_x,
                                                   bool log_y, std::size_t columns);

}  // namespace stickslip::plot
