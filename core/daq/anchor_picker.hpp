/// \file
/// One clock anchor for each half second: the read that came least late.
///
/// A read is late by what the board's driver, the scheduler and the load of the machine add: never early,
/// usually by a fraction of a scan, sometimes by much. The least of a window is what the board alone did
/// (the idea of NTP's clock filter, RFC 5905 section 10), and a window with one late read says as much as
/// one without.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/daq/clock_anchor.hpp"
#include "core/daq/scan_block.hpp"

namespace stickslip::daq {

/// Real-time safe.
class AnchorPicker {
 public:
  static constexpr double kWindow_s = 0.5;

  /// \param granted_Hz  positive.
  explicit AnchorPicker(double granted_Hz) noexcept
      : period_ns_(1e9 / granted_Hz),
        window_scans_(std::max<std::int64_t>(1, std::llround(kWindow_s * granted_Hz))) {}

  /// \return the anchor of the window that ended before this block, if one did and has any.
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

  /// The anchor of the window that has begun, if it has any; forgets it. Also to begin anew after a jump.
  [[nodiscard]] std::optional<ClockAnchor> flush() noexcept {
    window_open_ = false;
    std::optional<ClockAnchor> last;
    last.swap(best_);
    return last;
  }

  /// That of the window that has begun, so far.
  [[nodiscard]] const std::optional<ClockAnchor>& best() const noexcept { return best_; }

  /// How much later than `reference` this anchor was, by the granted rate, ns.
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
