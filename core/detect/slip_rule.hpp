/// \file
/// Slip rule: decides which falls are slips, for every trace and scan rate.
#pragma once

#include <cstdint>

#include "core/detect/fall_finder.hpp"

namespace stickslip::detect {

/// A slip is a fall that is significant against the measured noise and fast relative to the rise before it,
/// and the rise contains no fall of kLargestFallInStick of the drop or more. The rise begins at the trough of
/// the last significant fall. That before the first one takes Fall::rise_duration, but all falls of the trace
/// so far count as falls inside it. Limits are in standard deviations σ of the noise of one scan, in scans,
/// or ratios; none depends on the scan rate or the file.
///
/// They were placed on measured traces of paper on paper: textbook saw-teeth have slips of 16 σ up that take
/// at most 0.10 of the time of the rise before; a nearly sinusoidal trace has slips of 22 σ up that take at
/// most 0.85 of it. Irregular sliding has, among two dozen falls of 6–12 σ, at most six of 12–17 σ; each has
/// a smaller one of more than a third of it in the rise before, or takes 1.10 of the time of that rise or
/// more. So at 2000 scans/s and at every rate down to 350.
class SlipRule {
 public:
  /// Hysteresis of the turning points in σ: 9 standard deviations of the median of three, which are 0.67 σ
  /// each.
  static constexpr double kHysteresisSigmas = 6.0;
  /// Smallest Fall::robust_drop of a slip in σ.
  static constexpr double kSignificantSigmas = 12.0;
  /// Limit of the largest fall inside the rise, relative to the drop: with one of this size or more the sled
  /// was sliding, not sticking.
  static constexpr double kLargestFallInStick = 1.0 / 3.0;
  /// Largest error of Fall::duration, in scans: each of the crossings of 90 % and 10 % is up to one scan
  /// inside the counted interval. A slip's duration less this must not exceed that of the rise; in the model
  /// it is at most asin(0.8)/(π/2) = 0.59 of it, the 10–90 % time of half an oscillation.
  static constexpr double kDurationExcess = 2.0;

  /// To be called for every fall in the order of time, since small falls are what a rise contains.
  /// \param sigma  noise of one scan.
  [[nodiscard]] bool is_slip(const Fall& fall, double sigma) noexcept;

 private:
  double rise_started_at_ = -1.0;      ///< Where the last significant fall ended, in scans.
  double largest_fall_in_rise_ = 0.0;  ///< Since then.
};

}  // namespace stickslip::detect
