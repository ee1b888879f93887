/// \file
/// Ranges and ticks of axes.
#pragma once

#include <vector>

#include "report/plot/figure.hpp"

namespace stickslip::plot {

/// The range of the axis if it is set, else the extent of x in these panels.
[[nodiscard]] AxisRange x_range_of(const Axis& axis, const std::vector<const Panel*>& panels);

/// The y range of the panel if it is set, else the extent of y within the x range, with a margin.
[[nodiscard]] AxisRange y_range_of(const Panel& panel, const AxisRange& x);

/// The smallest step of 1, 2 or 5 times a power of ten of which at most `most_steps` (≥ 1) fit into the
/// range.
[[nodiscard]] double tick_step(const AxisRange& range, double most_steps);

}  // namespace stickslip::plot
