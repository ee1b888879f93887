/// \file
/// What the stamps of the blocks tell of this computer: that it stood still, that its date was set.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "core/daq/scan_block.hpp"

namespace stickslip::daq {

/// Real-time safe. Blocks in the order of their indices.
class ClockWatch {
 public:
  /// Scans that are read later than this were held up by a stall: the machine slept, a virtual one was
  /// paused, a debugger held the program, or the processor was taken.
  static constexpr double kStall_ns = 1e9;
  /// A date that moves by more against the monotonic clock was set; NTP slews by 0.5 ms/s. Also where the
  /// machine slept: the monotonic clock stands still then.
  static constexpr std::int64_t kStep_ns = 1'000'000'000;

  struct News {
    std::optional<double> stall_s;  ///< A stall is over: the block was read so late.
    std::optional<double> step_s;   ///< The date went so far ahead; negative: back.
  };

  /// \param late_ns  how late the block was read; none if that is not known.
  [[nodiscard]] News observe(const ClockStamp& stamp, std::optional<double> late_ns) noexcept {
    News news;
    const bool was_late = late_ns_ > 0.0;
    // Until what piled up is read: so one stall is told once.
    late_ns_ = late_ns.value_or(0.0) > (was_late ? 0.5 * kStall_ns : kStall_ns) ? *late_ns : 0.0;
    if (late_ns_ > 0.0 && !was_late) news.stall_s = 1e-9 * late_ns_;

    const std::int64_t ahead_ns = stamp.realtime_ns - stamp.monotonic_ns;
    if (!ahead_ns_) ahead_ns_ = ahead_ns;
    const bool stepped = std::abs(ahead_ns - *ahead_ns_) > kStep_ns;
    // Both clocks are read one after the other, and a stall can fall between: only what stays is a step.
    if (stepped && stepped_to_ns_ && std::abs(ahead_ns - *stepped_to_ns_) <= kStep_ns) {
      news.step_s = 1e-9 * static_cast<double>(ahead_ns - *ahead_ns_);
      ahead_ns_ = ahead_ns;
      stepped_to_ns_.reset();
    } else if (stepped) {
      stepped_to_ns_ = ahead_ns;
    } else {
      ahead_ns_ = ahead_ns;  // Follows what is slewed.
      stepped_to_ns_.reset();
    }
    return news;
  }

  /// How late the latest block was read if a stall held it up; else 0.
  [[nodiscard]] double late_ns() const noexcept { return late_ns_; }

 private:
  double late_ns_ = 0.0;
  std::optional<std::int64_t> ahead_ns_;       ///< Of the date before the monotonic clock.
  std::optional<std::int64_t> stepped_to_ns_;  ///< In the block before, alone so far.
};

}  // namespace stickslip::daq
