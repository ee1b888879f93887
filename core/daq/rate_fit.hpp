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
  std::int64_t anchor_count = 0;

  bool operator==(const RateEstimate&) const = default;
};

/// Real-time safe. A value: copies are pictures of a moment.
class RateFit {
 public:
  /// Fewer leave a standard error of so few degrees of freedom that nothing can be said from it.
  static constexpr std::int64_t kFewestAnchors = 5;

  /// \param granted_Hz  positive; only the origin from which deviations are summed.
  explicit RateFit(double granted_Hz) noexcept : period_ns_(1e9 / granted_Hz) {}

  /// \param anchor  its scan lies after all before.
  void add(const ClockAnchor& anchor) noexcept;
  /// The next anchor's index has no known distance from those before.
  void begin_segment() noexcept;

  /// None while there are too few anchors.
  [[nodiscard]] std::optional<RateEstimate> estimate() const noexcept;

 private:
  double period_ns_;
  std::optional<ClockAnchor> origin_;  ///< Of the segment.
  std::int64_t segment_size_ = 0;
  double mean_scan_ = 0.0;
  double mean_late_ns_ = 0.0;  ///< Time less index times granted period.
  std::int64_t anchors_ = 0;
  std::int64_t segments_ = 0;
  double scan_scan_ = 0.0;  ///< Sums of products of deviations from the segment's means.
  double scan_late_ = 0.0;
  double late_late_ = 0.0;
};

/// The fit of a test's anchors. \param gaps  of the test; those whose length was estimated part the anchors.
[[nodiscard]] std::optional<RateEstimate> fit_rate(std::span<const ClockAnchor> anchors,
                                                   std::span<const Gap> gaps, double granted_Hz) noexcept;

}  // namespace stickslip::daq
