/// \file
/// The rise of the force before a slip: from where it is a line, and how steep that is.
#pragma once

#include <span>

#include "core/estimate/cycle_buffer.hpp"

namespace stickslip::detect {

/// From a turning point to the peak after it.
struct Rise {
  double from;     ///< Value at the turning point,
  double peak;     ///< and at the peak.
  double begin_s;  ///< Time of the turning point,
  double peak_s;   ///< and of the peak, later.

  /// A first loading has a rounded start, and rest before it.
  /// \param points  among them those of the rise. \return when the line begins, from_s at the earliest.
  [[nodiscard]] double line_from_s(std::span<const estimate::CyclePoint> points,
                                   double from_s) const noexcept;
  /// Of the stick, 1/s: its stick rate. By the points from from_s on, or the whole rise where they tell
  /// nothing. \param sigma  noise of one scan.
  [[nodiscard]] double slope(std::span<const estimate::CyclePoint> points, double from_s,
                             double sigma) const noexcept;
};

}  // namespace stickslip::detect
