/// \file
/// The true rate of an acquisition while it runs, and with it where the index goes on after a halt.
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

/// All that is needed to number the scans after a halt, also on another board object.
struct Continuation {
  ScanIndex end = 0;        ///< One past the last scan delivered.
  ClockAnchor anchor;       ///< A scan of which the time is known.
  double scan_rate_Hz = 0;  ///< Measured where that is known well, else granted.
};

/// The index of the first scan of a board that is started now: it comes one period later. The scans since
/// `from` are counted by the clock, and at least one was lost.
[[nodiscard]] ScanIndex first_scan_after(const Continuation& from, std::int64_t now_ns) noexcept;

/// Real-time safe.
class RateMeter {
 public:
  explicit RateMeter(double granted_Hz) noexcept
      : granted_Hz_(granted_Hz), picker_(granted_Hz), fit_(granted_Hz) {}

  /// Blocks in the order of their indices.
  void observe(const ScanBlock& block) noexcept;
  /// A board was started; its first scan, one period after `now_ns`, has this index. No distance to the
  /// scans before is known but what the clock said.
  void started(ScanIndex first, std::int64_t now_ns) noexcept;
  /// The index of the coming block was derived from a clock.
  void restarted() noexcept;

  /// Of all blocks so far; none before there are enough anchors.
  [[nodiscard]] std::optional<RateEstimate> estimate() const noexcept { return fit_.estimate(); }
  /// None before anything was observed.
  [[nodiscard]] std::optional<Continuation> continuation() const noexcept;
  /// How late this block was read, compared with the most prompt one of late, ns; none at the beginning.
  [[nodiscard]] std::optional<double> lateness_ns(const ScanBlock& block) const noexcept;

 private:
  /// Beyond this the granted rate is as good a guess over the length of a gap.
  static constexpr double kUsableRelativeError = 100e-6;

  double granted_Hz_;
  AnchorPicker picker_;
  RateFit fit_;
  ScanIndex end_ = 0;
  std::optional<ClockAnchor> latest_;
};

}  // namespace stickslip::daq
