/// \file
/// The rise of the force before a slip: start and slope of its linear part.
#pragma once

#include <span>

#include "core/estimate/cycle_buffer.hpp"

namespace stickslip::detect {

/// A rise of the force, from a turning point to the peak after it. Times are those of the points.
struct Rise {
  double from;     ///< Value at the turning point,
  double peak;     ///< and at the peak.
  double begin_s;  ///< Time of the turning point,
  double peak_s;   ///< and of the peak, later.

  /// Start of the linear part, s; a first loading has a rounded start, with rest before it.
  /// \param points  include those of the rise.
  /// \return of the points from from_s to the peak, the begin of the one that follows the last one below 30 %
  /// of the rise: from_s if none is below, peak_s if none follows.
  [[nodiscard]] double line_from_s(std::span<const estimate::CyclePoint> points,
                                   double from_s) const noexcept;
  /// Slope of the stick, 1/s, from the points between 30 and 70 % of the rise, from from_s on; between 10 and
  /// 80 % if those are fewer than eight; from the turning points if these give no positive slope.
  /// \param sigma  noise of one scan.
  [[nodiscard]] double slope(std::span<const estimate::CyclePoint> points, double from_s,
                             double sigma) const noexcept;
};

}  // namespace stickslip::detect
