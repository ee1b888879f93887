#include "core/daq/rate_fit.hpp"

#include <algorithm>
#include <cmath>

namespace stickslip::daq {

void RateFit::add(const ClockAnchor& anchor) noexcept {
  if (!origin_) {
    origin_ = anchor;
    ++segments_;
  }
  // Differences of integers first: an index of months times a period would have no digits left for a ppm.
  const auto scan = static_cast<double>(anchor.scan - origin_->scan);
  const double late_ns = static_cast<double>(anchor.monotonic_ns - origin_->monotonic_ns) - scan * period_ns_;
  ++anchors_;
  ++segment_size_;
  const auto size = static_cast<double>(segment_size_);
  const double scan_step = scan - mean_scan_;
  const double late_step = late_ns - mean_late_ns_;
  mean_scan_ += scan_step / size;
  mean_late_ns_ += late_step / size;
  scan_scan_ += scan_step * (scan - mean_scan_);
  scan_late_ += scan_step * (late_ns - mean_late_ns_);
  late_late_ += late_step * (late_ns - mean_late_ns_);
}

void RateFit::begin_segment() noexcept {
  origin_.reset();
  segment_size_ = 0;
  mean_scan_ = 0.0;
  mean_late_ns_ = 0.0;
}

std::optional<RateEstimate> RateFit::estimate() const noexcept {
  const std::int64_t freedom = anchors_ - segments_ - 1;
  if (anchors_ < kFewestAnchors || freedom < 1 || !(scan_scan_ > 0.0)) return std::nullopt;
  const double slope_ns = scan_late_ / scan_scan_;
  const double rest = std::max(0.0, late_late_ - slope_ns * scan_late_);
  const double slope_error_ns = std::sqrt(rest / static_cast<double>(freedom) / scan_scan_);
  const double period_ns = period_ns_ + slope_ns;
  if (!(period_ns > 0.0)) return std::nullopt;
  const double rate_Hz = 1e9 / period_ns;
  return RateEstimate{rate_Hz, rate_Hz * slope_error_ns / period_ns, anchors_};
}

std::optional<RateEstimate> fit_rate(std::span<const ClockAnchor> anchors, std::span<const Gap> gaps,
                                     double granted_Hz) noexcept {
  RateFit fit{granted_Hz};
  auto gap = gaps.begin();
  for (const ClockAnchor& anchor : anchors) {
    for (; gap != gaps.end() && gap->first <= anchor.scan; ++gap) {
      if (gap->estimated) fit.begin_segment();
    }
    fit.add(anchor);
  }
  return fit.estimate();
}

}  // namespace stickslip::daq
