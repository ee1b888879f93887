/// \file
/// Which falls are slips? One rule for every trace, rate and file.
#pragma once

#include <cstdint>

#include "core/detect/fall_finder.hpp"

namespace stickslip::detect {

/// A slip is a fall that is significant against the measured noise and fast against the stick
/// before it, and that stick is one: the force climbed without falling on the way. Limits are
/// in standard deviations σ of the noise of one scan, or ratios; none depends on rate or file.
///
/// They were placed on measured traces of paper on paper: textbook saw-teeth have slips of 16 σ up
/// with falls of at most 0.10 of the rise before; a nearly sinusoidal trace has slips of 22 σ up
/// and falls of at most 0.85 of the rise. Irregular sliding has, among two dozen falls of 6–12 σ,
/// at most six of 12–17 σ; each has a smaller one of more than a third of it in the rise before, or
/// takes 1.10 of that rise or more. So at 2000 scans/s and at every rate down to 350.
class SlipRule {
 public:
  /// Hysteresis of the turning points in σ: noise alone, through a median of three (which leaves
  /// 0.67 σ), would have to swing over 9 of its own standard deviations.
  static constexpr double kHysteresisSigmas = 6.0;
  /// Smallest drop of a slip in σ.
  static constexpr double kSignificantSigmas = 12.0;
  /// A fall inside the rise larger than this part of the drop: the sled was sliding, not sticking.
  static constexpr double kLargestFallInStick = 1.0 / 3.0;
  /// Fall::duration counts from scan to scan: 90 % is crossed up to a scan after the one, 10 % up to a scan
  /// before the other. What took less for certain must not take longer than the rise; in the model it takes
  /// at most 0.59 of it, asin(0.8)/(π/2), as half a swing has its 10–90 %.
  static constexpr double kDurationExcess = 2.0;

  /// \param falls come in the order of time. \param sigma noise of one scan.
  [[nodiscard]] bool is_slip(const Fall& fall, double sigma) noexcept;

 private:
  double rise_started_at_ = -1.0;      ///< Where the last significant fall ended, in scans.
  double largest_fall_in_rise_ = 0.0;  ///< Since then.
};

}  // namespace stickslip::detect
