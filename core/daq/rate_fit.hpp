/// \file
/// The true scan rate from clock anchors: least squares of monotonic time against index.
///
///     RateFit fit{granted_Hz};
///     for (const ClockAnchor& anchor : anchors) fit.add(anchor);
///     if (const auto rate = fit.estimate()) show(rate->rate_Hz, rate->standard_error_Hz);
///
/// After an overrun the index is derived from a clock, and the jump there has no information about the rate.
/// begin_segment() gives the following anchors an intercept of their own; the slope is common. Centred
/// running sums (Welford) keep the precision over months.
///
/// A read can only be late, never early: after a stall of the computer the backlog is read in a burst. So if
/// two anchors disagree, the one with the smaller delay is right. An anchor that is too late relative to the
/// last one used is ignored, unless it is the kLastingDelay-th in a row. One that is too early shows that
/// those before it were late, or that the clock stopped (a suspended machine); it begins a segment. A segment
/// of one anchor has no information about the rate, so a test that was read in one burst has no estimate.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/daq/clock_anchor.hpp"
#include "core/daq/gap.hpp"

namespace stickslip::daq {

/// Fitted scan rate.
struct RateEstimate {
  double rate_Hz = 0.0;
  double standard_error_Hz = 0.0;  ///< From the scatter of the anchors about the line.
  std::int64_t anchor_count = 0;   ///< Anchors used: those in segments of two or more.

  bool operator==(const RateEstimate&) const = default;
};

/// Running fit of the scan rate. Real-time safe. Copyable; a copy is a snapshot.
class RateFit {
 public:
  /// Fewest anchors that give an estimate; with fewer the standard error has too few degrees of freedom.
  static constexpr std::int64_t kFewestAnchors = 5;

  /// Two anchors agree if the clock time between them equals the time of the scans at the expected rate to
  /// within kUsualDelay_ns + min(kRateDoubt · time, kLongestDrift_ns), and is at least a tenth of it; less
  /// is a burst, and begins a segment. kRateDoubt is the relative uncertainty of the expected rate.
  static constexpr double kRateDoubt = 0.02;
  static constexpr double kLongestDrift_ns = 100e6;
  /// Usual delay of a read, ns.
  static constexpr double kUsualDelay_ns = 20e6;
  /// Number of late anchors in a row that are taken for uncounted missing scans instead of late reads; a new
  /// segment begins.
  static constexpr int kLastingDelay = 5;

  /// \param granted_Hz  positive; the sums are of deviations from this rate.
  /// \param expected_Hz  positive; rate by which anchors are compared.
  RateFit(double granted_Hz, double expected_Hz) noexcept
      : period_ns_(1e9 / granted_Hz), expected_ns_(1e9 / expected_Hz) {}
  explicit RateFit(double granted_Hz) noexcept : RateFit(granted_Hz, granted_Hz) {}

  /// \param anchor  with a scan after all earlier ones. \return false if it was late and is ignored.
  bool add(const ClockAnchor& anchor) noexcept;
  /// Begins a segment: the distance of the next anchor's index from earlier ones is unknown.
  void begin_segment() noexcept;

  /// Nullopt while fewer than kFewestAnchors are in segments of two or more.
  [[nodiscard]] std::optional<RateEstimate> estimate() const noexcept;

 private:
  double period_ns_;
  double expected_ns_;
  std::optional<ClockAnchor> origin_;  ///< Of the segment.
  ClockAnchor last_;                   ///< Of the segment.
  int late_in_a_row_ = 0;
  std::int64_t segment_size_ = 0;
  double mean_scan_ = 0.0;
  double mean_late_ns_ = 0.0;  ///< Time minus index times granted period.
  std::int64_t anchors_ = 0;   ///< In segments of two or more.
  std::int64_t segments_ = 0;
  double scan_scan_ = 0.0;  ///< Sums of products of deviations from the segment's means.
  double scan_late_ = 0.0;
  double late_late_ = 0.0;
};

/// Fits the anchors of a test; nullopt as RateFit::estimate(). The expected rate is the median of the rates
/// between neighbours, or granted_Hz if the median is off by a factor of ten or more.
/// \param anchors,gaps  in the order of their scans; an estimated gap begins a segment.
[[nodiscard]] std::optional<RateEstimate> fit_rate(std::span<const ClockAnchor> anchors,
                                                   std::span<const Gap> gaps, double granted_Hz);

}  // namespace stickslip::daq
