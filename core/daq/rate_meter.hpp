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
  ScanIndex end = 0;        ///< One past the last scan delivered.
  ClockAnchor anchor;       ///< Scan with known time.
  double scan_rate_Hz = 0;  ///< Measured if precise enough, else granted.
};

/// Index of the first scan of a board started at `now_ns`, one period later. The clock gives the number of
/// scans since `from`; at least one counts as lost.
[[nodiscard]] ScanIndex first_scan_after(const Continuation& from, std::int64_t now_ns) noexcept;

/// Real-time safe.
class RateMeter {
 public:
  explicit RateMeter(double granted_Hz) noexcept
      : granted_Hz_(granted_Hz), picker_(granted_Hz), fit_(granted_Hz) {}

  /// Blocks in the order of their indices.
  void observe(const ScanBlock& block) noexcept;
  /// To be called when a board was started whose first scan, one period after `now_ns`, has index `first`.
  /// The distance to earlier scans comes from the clock only.
  void started(ScanIndex first, std::int64_t now_ns) noexcept;
  /// To be called when the index of the next block was derived from a clock.
  void restarted() noexcept;

  /// Rate over all blocks so far; nullopt with too few anchors.
  [[nodiscard]] std::optional<RateEstimate> estimate() const noexcept { return fit_.estimate(); }
  /// Nullopt before the first block.
  [[nodiscard]] std::optional<Continuation> continuation() const noexcept;
  /// Delay of this block relative to the most prompt of the recent ones, ns; nullopt at the beginning.
  [[nodiscard]] std::optional<double> lateness_ns(const ScanBlock& block) const noexcept;

 private:
  /// Largest relative standard error at which the measured rate is preferred to the granted one.
  static constexpr double kUsableRelativeError = 100e-6;

  double granted_Hz_;
  AnchorPicker picker_;
  RateFit fit_;
  ScanIndex end_ = 0;
  std::optional<ClockAnchor> latest_;
};

}  // namespace stickslip::daq
