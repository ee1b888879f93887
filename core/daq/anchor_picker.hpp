/// \file
/// Selects one clock anchor for each half second: the read with the smallest delay.
///
/// Driver, scheduler and load of the machine delay a read: usually by a fraction of a scan period, sometimes
/// by much, and never negatively. The minimum over a window is the delay of the board alone, as in NTP's
/// clock filter (RFC 5905, section 10), so a single late read has no effect.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/daq/clock_anchor.hpp"
#include "core/daq/scan_block.hpp"

namespace stickslip::daq {

/// Selects the clock anchors of an acquisition from its blocks, in their order. Real-time safe.
class AnchorPicker {
 public:
  static constexpr double kWindow_s = 0.5;

  /// \param granted_Hz  positive.
  explicit AnchorPicker(double granted_Hz) noexcept
      : period_ns_(1e9 / granted_Hz),
        window_scans_(std::max<std::int64_t>(1, std::llround(kWindow_s * granted_Hz))) {}

  /// Takes the next block. One that was not read promptly can be no anchor; an empty one is ignored.
  /// \return the anchor of the window before this block, if this block begins a new window and that one had a
  /// prompt read.
  [[nodiscard]] std::optional<ClockAnchor> observe(const ScanBlock& block) noexcept {
    std::optional<ClockAnchor> picked;
    const ScanIndex last = block.end() - 1;
    if (block.count == 0) return picked;
    if (!window_open_) {
      window_open_ = true;
      window_end_ = block.first + window_scans_;
    }
    if (last >= window_end_) {
      picked = best_;
      best_.reset();
      window_end_ = block.first + window_scans_;
    }
    if (!block.stamp.prompt) return picked;
    const ClockAnchor candidate{last, block.stamp.monotonic_ns, block.stamp.realtime_ns};
    if (!best_ || lateness_ns(candidate, *best_) < 0.0) best_ = candidate;
    return picked;
  }

  /// Returns and removes the anchor of the present window, if any; the next block starts a new window. Call
  /// it also where the index jumps by an estimate, since delays across the jump cannot be compared.
  [[nodiscard]] std::optional<ClockAnchor> flush() noexcept {
    window_open_ = false;
    std::optional<ClockAnchor> last;
    last.swap(best_);
    return last;
  }

  /// Anchor of the present window so far, if any.
  [[nodiscard]] const std::optional<ClockAnchor>& best() const noexcept { return best_; }

  /// How much later this anchor was read than the granted rate predicts from `reference`, ns; < 0: earlier.
  [[nodiscard]] double lateness_ns(const ClockAnchor& anchor, const ClockAnchor& reference) const noexcept {
    return static_cast<double>(anchor.monotonic_ns - reference.monotonic_ns) -
           static_cast<double>(anchor.scan - reference.scan) * period_ns_;
  }

 private:
  double period_ns_;
  std::int64_t window_scans_;
  bool window_open_ = false;
  ScanIndex window_end_ = 0;
  std::optional<ClockAnchor> best_;
};

}  // namespace stickslip::daq
