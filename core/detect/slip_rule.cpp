#include "core/detect/slip_rule.hpp"

#include <algorithm>

namespace stickslip::detect {

bool SlipRule::is_slip(const Fall& fall, double sigma) noexcept {
  if (fall.robust_drop < kSignificantSigmas * sigma) {
    largest_fall_in_rise_ = std::max(largest_fall_in_rise_, fall.robust_drop);
    return false;
  }
  const double rise_began = rise_started_at_ < 0.0 ? fall.peak_at - fall.rise_duration : rise_started_at_;
  const bool stick_before = largest_fall_in_rise_ < kLargestFallInStick * fall.robust_drop;
  const bool fast = fall.duration - kDurationExcess <= fall.peak_at - rise_began;
  rise_started_at_ = fall.trough_at;
  largest_fall_in_rise_ = 0.0;
  return stick_before && fast;
}

}  // namespace stickslip::detect
