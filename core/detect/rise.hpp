/// \file
/// The rise of the force before a slip: start and slope of its linear part.
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

  /// Start of the linear part; a first loading has a rounded start, with rest before it.
  /// \param points  include those of the rise.
  /// \return time at which the line begins, from_s at the earliest.
  [[nodiscard]] double line_from_s(std::span<const estimate::CyclePoint> points,
                                   double from_s) const noexcept;
  /// Slope of the stick, 1/s, from the points from from_s on; from the whole rise if these are too few.
  /// \param sigma  noise of one scan.
  [[nodiscard]] double slope(std::span<const estimate::CyclePoint> points, double from_s,
                             double sigma) const noexcept;
};

}  // namespace stickslip::detect
