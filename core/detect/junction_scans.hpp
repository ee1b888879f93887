/// \file
/// Scans from one peak of the force to the trough after the next peak, reduced to a bounded number of points,
/// so that the computing time does not depend on scan rate and length of the stick.
#pragma once

#include <cstddef>
#include <vector>

#include "core/estimate/trace.hpp"
#include "core/model/slip_model.hpp"

namespace stickslip::detect {

/// One scan, or the mean of neighbours.
struct JunctionPoint {
  double tau_s = 0.0;       ///< After the first scan.
  double value = 0.0;       ///< Coefficient without drift.
  double root_count = 1.0;  ///< √ of the number of scans: the mean's noise is σ over it.

  // e^(−γt/2) cos ωt and e^(−γt/2) sin ωt, worked out once: for t = τ, and for t counted from the last point,
  // as the second slip needs them.
  double cosine = 0.0;
  double sine = 0.0;
  double cosine_to_end = 0.0;
  double sine_to_end = 0.0;
};

/// Points of the usable scans in [first, end): each scan is a point if there are few. Otherwise neighbours
/// are averaged: the 1.25 periods at each end, which contain the slips, become 96 points each, the line
/// between them 64. A mean over 1/77 of a period is off the curve by (2π/77)²/24 = 0.03 % of the amplitude.
/// Holds one junction at a time and reuses its memory.
class JunctionScans {
 public:
  static constexpr std::size_t kMostPoints = 256;

  JunctionScans();
  void read(const estimate::Trace& trace, std::size_t first, std::size_t end,
            const model::SharedParameters& shared);

  [[nodiscard]] const std::vector<JunctionPoint>& points() const noexcept { return points_; }
  [[nodiscard]] std::size_t scan_count() const noexcept { return scan_count_; }
  [[nodiscard]] double lowest() const noexcept { return lowest_; }    ///< Of the points.
  [[nodiscard]] double highest() const noexcept { return highest_; }  ///< Of the points.

 private:
  std::vector<JunctionPoint> points_;
  std::size_t scan_count_ = 0;
  double lowest_ = 0.0;
  double highest_ = 0.0;
};

}  // namespace stickslip::detect
