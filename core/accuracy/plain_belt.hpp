/// \file
/// Belt with a constant speed in each segment, for the stepping methods.
#pragma once

#include <cstddef>
#include <limits>

#include "core/sim/motion.hpp"

namespace stickslip::accuracy {

/// The belt at a time that moves forward: its rate, and when that changes.
class PlainBelt {
 public:
  /// \param motion  outlives this; lacks_reference() is empty.
  explicit PlainBelt(const sim::Motion& motion) : motion_(&motion) { pass(0.0); }

  /// r = ω₀² v/g, 1/s; 0 from halt() to the end of its segment, and after the last segment.
  [[nodiscard]] double rate() const noexcept { return rate_; }
  /// When the present segment ends, s after scan 0; infinity after the last.
  [[nodiscard]] double end_s() const noexcept { return end_s_; }
  /// Whether the belt stops as soon as the force is gone; the caller then calls halt().
  [[nodiscard]] bool halts_when_unloaded() const noexcept { return halts_; }
  /// Stops the belt for the rest of the segment.
  void halt() noexcept {
    halts_ = false;
    rate_ = 0.0;
  }

  /// Goes to the segment at now_s, which must not fall from call to call.
  void pass(double now_s) {
    while (end_s_ <= now_s) {
      halts_ = false;
      rate_ = 0.0;
      if (next_ == motion_->belt.size()) {
        end_s_ = std::numeric_limits<double>::infinity();
        return;
      }
      const sim::BeltSegment& segment = motion_->belt[next_++];
      rate_ = motion_->oscillator.stick_rate_per_s(segment.speed_m_per_s, motion_->gravity_m_per_s2);
      halts_ = segment.halt_when_unloaded;
      end_s_ += segment.duration_s;
    }
  }

 private:
  const sim::Motion* motion_;
  std::size_t next_ = 0;
  double rate_ = 0.0;
  double end_s_ = 0.0;
  bool halts_ = false;
};

}  // namespace stickslip::accuracy
