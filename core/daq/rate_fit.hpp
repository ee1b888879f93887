/// \file
/// The true scan rate from clock anchors: least squares of time against index.
///
///     RateFit fit{granted_Hz};
///     for (const ClockAnchor& anchor : anchors) fit.add(anchor);
///     if (const auto rate = fit.estimate()) show(rate->rate_Hz, rate->standard_error_Hz);
///
/// An index that was itself derived from a clock (after an overrun) says nothing about the rate across the
/// place where it was derived: begin_segment() gives what follows an intercept of its own, the slope is
/// common. Sums are centred as they grow (Welford), so a session of months keeps its digits.
///
/// A read can only be late, never early: the computer stalled, and what piled up is then read in a burst. So
/// of two anchors that do not agree the earlier reading is right. An anchor that is later than the one before
/// allows does not count; one that is earlier shows that those before were late, or that the clock stood
/// still (a suspended machine), and begins a segment. Segments of one anchor say nothing about the rate: a
/// whole test that was read in a burst gives none.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/daq/clock_anchor.hpp"
#include "core/daq/gap.hpp"

namespace stickslip::daq {

struct RateEstimate {
  double rate_Hz = 0.0;
  double standard_error_Hz = 0.0;  ///< From the scatter of the anchors about the line.
  std::int64_t anchor_count = 0;   ///< Those that count.

  bool operator==(const RateEstimate&) const = default;
};

/// Real-time safe. A value: copies are pictures of a moment.
class RateFit {
 public:
  /// Fewer leave a standard error of so few degrees of freedom that nothing can be said from it.
  static constexpr std::int64_t kFewestAnchors = 5;

  /// Two anchors agree if the clock between them went as the scans say, but for so much of that time (no
  /// more than kLongestDrift_ns), the rate not being known better,
  static constexpr double kRateDoubt = 0.02;
  static constexpr double kLongestDrift_ns = 100e6;
  /// and for so much that any read may be late.
  static constexpr double kUsualDelay_ns = 20e6;
  /// So many late ones in a row are no late reads: scans went missing that nobody counted.
  static constexpr int kLastingDelay = 5;

  /// \param granted_Hz  positive; the origin from which deviations are summed.
  /// \param expected_Hz  positive; the rate by which anchors are compared.
  RateFit(double granted_Hz, double expected_Hz) noexcept
      : period_ns_(1e9 / granted_Hz), expected_ns_(1e9 / expected_Hz) {}
  explicit RateFit(double granted_Hz) noexcept : RateFit(granted_Hz, granted_Hz) {}

  /// \param anchor  its scan lies after all before. \return false if it was read late and does not count.
  bool add(const ClockAnchor& anchor) noexcept;
  /// The next anchor's index has no known distance from those before.
  void begin_segment() noexcept;

  /// None while there are too few anchors that count.
  [[nodiscard]] std::optional<RateEstimate> estimate() const noexcept;

 private:
  double period_ns_;
  double expected_ns_;
  std::optional<ClockAnchor> origin_;  ///< Of the segment.
  ClockAnchor last_;                   ///< Of the segment.
  int late_in_a_row_ = 0;
  std::int64_t segment_size_ = 0;
  double mean_scan_ = 0.0;
  double mean_late_ns_ = 0.0;  ///< Time less index times granted period.
  std::int64_t anchors_ = 0;   ///< In segments of two and more.
  std::int64_t segments_ = 0;
  double scan_scan_ = 0.0;  ///< Sums of products of deviations from the segment's means.
  double scan_late_ = 0.0;
  double late_late_ = 0.0;
};

/// The fit of a test's anchors, compared by the pace of most of them.
/// \param gaps  of the test; those whose length was estimated part the anchors.
[[nodiscard]] std::optional<RateEstimate> fit_rate(std::span<const ClockAnchor> anchors,
                                                   std::span<const Gap> gaps, double granted_Hz);

}  // namespace stickslip::daq
