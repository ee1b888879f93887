/// \file
/// Detects stalls of the computer and steps of its date, from the stamps of the blocks.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "core/daq/scan_block.hpp"

namespace stickslip::daq {

/// Watches an acquisition's blocks, in the order of their indices, for stalls and steps of the date.
/// Real-time safe.
class ClockWatch {
 public:
  /// Delay of a read above which it counts as a stall: a virtual machine was paused, a debugger stopped the
  /// program, or the processor was not available.
  static constexpr double kStall_ns = 1e9;
  /// Change of the date relative to the monotonic clock, since the block before, above which it counts as a
  /// step; NTP slews by 0.5 ms/s. A suspend is no step, since both clocks go on.
  static constexpr std::int64_t kStep_ns = 1'000'000'000;

  /// Events found at one block.
  struct News {
    std::optional<double> stall_s;  ///< Delay of the block that a stall held up, s.
    std::optional<double> step_s;   ///< Step of the date, s; positive: forward.
  };

  /// Takes the stamp of the next block. A stall is reported once, at its first late block, and lasts until
  /// the delay is at most half of kStall_ns. A step is reported at the second block in a row that shows it.
  /// \param late_ns  delay of the block's read, ns; nullopt if unknown, which counts as no delay.
  [[nodiscard]] News observe(const ClockStamp& stamp, std::optional<double> late_ns) noexcept {
    News news;
    const bool was_late = late_ns_ > 0.0;
    // Stays set until the backlog is read, so that one stall is reported once.
    late_ns_ = late_ns.value_or(0.0) > (was_late ? 0.5 * kStall_ns : kStall_ns) ? *late_ns : 0.0;
    if (late_ns_ > 0.0 && !was_late) news.stall_s = 1e-9 * late_ns_;

    const std::int64_t ahead_ns = stamp.realtime_ns - stamp.monotonic_ns;
    if (!ahead_ns_) ahead_ns_ = ahead_ns;
    const bool stepped = std::abs(ahead_ns - *ahead_ns_) > kStep_ns;
    // The two clocks are read one after the other, and a stall may lie between. Only a difference that
    // persists is a step.
    if (stepped && stepped_to_ns_ && std::abs(ahead_ns - *stepped_to_ns_) <= kStep_ns) {
      news.step_s = 1e-9 * static_cast<double>(ahead_ns - *ahead_ns_);
      ahead_ns_ = ahead_ns;
      stepped_to_ns_.reset();
    } else if (stepped) {
      stepped_to_ns_ = ahead_ns;
    } else {
      ahead_ns_ = ahead_ns;  // Follows slewing.
      stepped_to_ns_.reset();
    }
    return news;
  }

  /// Delay of the latest block if a stall held it up, ns; else 0.
  [[nodiscard]] double late_ns() const noexcept { return late_ns_; }

 private:
  double late_ns_ = 0.0;
  std::optional<std::int64_t> ahead_ns_;       ///< Date minus monotonic clock.
  std::optional<std::int64_t> stepped_to_ns_;  ///< New difference seen once, in the block before.
};

}  // namespace stickslip::daq
