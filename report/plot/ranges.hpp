/// \file
/// What the axes of a figure show where nobody says it.
#pragma once

#include <vector>

#include "report/plot/figure.hpp"

namespace stickslip::plot {

/// The axis's own range, else all x of these panels.
[[nodiscard]] AxisRange x_range_of(const Axis& axis, const std::vector<const Panel*>& panels);

/// The panel's own range, else all y within the x range, with a little room.
[[nodiscard]] AxisRange y_range_of(const Panel& panel, const AxisRange& x);

/// 1, 2 or 5 times a power of ten, so that at most so many steps (≥ 1) fit into the range.
[[nodiscard]] double tick_step(const AxisRange& range, double most_steps);

}  // namespace stickslip::plot
