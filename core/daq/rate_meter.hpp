/// \file
/// True scan rate during an acquisition, and the scan index at which it continues after a halt.
///
///     RateMeter meter{info.scan_rate_granted_Hz};
///     meter.observe(block);                        // each block
///     if (const auto from = meter.continuation()) next = first_scan_after(*from, clock.monotonic_ns());
#pragma once

#include <cstdint>
#include <optional>

#include "core/daq/anchor_picker.hpp"
#include "core/daq/rate_fit.hpp"

namespace stickslip::daq {

/// State from which scans are numbered after a halt, also with another board object.
struct Continuation {
  /// One past the last scan that the board delivered; after RateMeter::started(), until a scan comes, the
  /// index of the first one due.
  ScanIndex end = 0;
  ClockAnchor anchor;       ///< A scan whose monotonic time is known; realtime_ns may be 0.
  double scan_rate_Hz = 0;  ///< Measured if known to 100 ppm, else granted.
};

/// Index of the first scan of a board that was started at `now_ns` (Clock::monotonic_ns()) and takes this
/// scan one period later. The time since from.anchor gives the number of scans; at least one counts as lost.
[[nodiscard]] ScanIndex first_scan_after(const Continuation& from, std::int64_t now_ns) noexcept;

/// Measures the scan rate, and the delay of each read, during an acquisition. Real-time safe.
class RateMeter {
 public:
  explicit RateMeter(double granted_Hz) noexcept
      : granted_Hz_(granted_Hz), picker_(granted_Hz), fit_(granted_Hz) {}

  /// To be called with each block that is not empty, in the order of their indices.
  void observe(const ScanBlock& block) noexcept;
  /// To be called when a board was started whose first scan, one period after `now_ns`, has index `first`.
  /// The distance to earlier scans comes from the clock only.
  void started(ScanIndex first, std::int64_t now_ns) noexcept;
  /// To be called when the index of the next block was derived from a clock.
  void restarted() noexcept;

  /// Rate over all blocks up to the last anchor; nullopt as RateFit::estimate().
  [[nodiscard]] std::optional<RateEstimate> estimate() const noexcept { return fit_.estimate(); }
  /// State after the last block. Its anchor is the latest one as of lateness_ns(); before the first, the most
  /// prompt read so far. If no block since construction or restarted() was read promptly, it is the last
  /// block, however late: fewer scans then count as lost. Nullopt before the first block or started().
  [[nodiscard]] std::optional<Continuation> continuation() const noexcept;
  /// Delay of this block's read relative to the latest anchor, the most prompt read of an earlier half
  /// second, ns; negative: earlier. Nullopt for an empty block and before the first anchor after construction
  /// or restarted(); started() sets one.
  [[nodiscard]] std::optional<double> lateness_ns(const ScanBlock& block) const noexcept;

 private:
  /// Largest relative standard error at which the measured rate is preferred to the granted one.
  static constexpr double kUsableRelativeError = 100e-6;

  double granted_Hz_;
  AnchorPicker picker_;
  RateFit fit_;
  ScanIndex end_ = 0;
  std::optional<ClockAnchor> latest_;
  std::optional<ClockAnchor> last_;  ///< Of the last block, prompt or not.
};

}  // namespace stickslip::daq
