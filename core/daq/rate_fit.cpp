#include "core/daq/rate_fit.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace stickslip::daq {
namespace {

/// Factor between median and granted rate beyond which the anchors are a backlog read in a burst. No known
/// board is off by as much, and a backlog is read thousands of times faster.
constexpr double kFarthestRate = 10.0;

/// Median of the rates between neighbouring anchors; the granted rate if most of them were read in a burst.
double usual_rate_Hz(std::span<const ClockAnchor> anchors, double granted_Hz) {
  std::vector<double> period_ns;
  for (std::size_t i = 1; i < anchors.size(); ++i) {
    const std::int64_t scans = anchors[i].scan - anchors[i - 1].scan;
    if (scans <= 0) continue;
    period_ns.push_back(static_cast<double>(anchors[i].monotonic_ns - anchors[i - 1].monotonic_ns) /
                        static_cast<double>(scans));
  }
  if (period_ns.empty()) return granted_Hz;
  const auto middle = period_ns.begin() + static_cast<std::ptrdiff_t>(period_ns.size() / 2);
  std::nth_element(period_ns.begin(), middle, period_ns.end());
  const double factor = 1e9 / (*middle * granted_Hz);
  return factor > 1.0 / kFarthestRate && factor < kFarthestRate ? factor * granted_Hz : granted_Hz;
}

}  // namespace

bool RateFit::add(const ClockAnchor& anchor) noexcept {
  if (origin_) {
    const double due_ns = static_cast<double>(anchor.scan - last_.scan) * expected_ns_;
    const auto took_ns = static_cast<double>(anchor.monotonic_ns - last_.monotonic_ns);
    const double late_ns = took_ns - due_ns;
    const double allowed_ns = kUsualDelay_ns + std::min(kRateDoubt * due_ns, kLongestDrift_ns);
    if (late_ns > allowed_ns && ++late_in_a_row_ < kLastingDelay) return false;
    const bool in_a_burst = took_ns * kFarthestRate < due_ns;  // Also where they are close to each other.
    if (std::abs(late_ns) > allowed_ns || in_a_burst) begin_segment();
  }
  late_in_a_row_ = 0;
  last_ = anchor;
  if (!origin_) origin_ = anchor;
  // Differences of integers first: an index of months times a period would have no digits left for a ppm.
  const auto scan = static_cast<double>(anchor.scan - origin_->scan);
  const double late_ns = static_cast<double>(anchor.monotonic_ns - origin_->monotonic_ns) - scan * period_ns_;
  ++segment_size_;
  if (segment_size_ == 2) ++segments_;
  if (segment_size_ >= 2) anchors_ += segment_size_ == 2 ? 2 : 1;
  const auto size = static_cast<double>(segment_size_);
  const double scan_step = scan - mean_scan_;
  const double late_step = late_ns - mean_late_ns_;
  mean_scan_ += scan_step / size;
  mean_late_ns_ += late_step / size;
  scan_scan_ += scan_step * (scan - mean_scan_);
  scan_late_ += scan_step * (late_ns - mean_late_ns_);
  late_late_ += late_step * (late_ns - mean_late_ns_);
  return true;
}

void RateFit::begin_segment() noexcept {
  origin_.reset();
  late_in_a_row_ = 0;
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
                                     double granted_Hz) {
  RateFit fit{granted_Hz, usual_rate_Hz(anchors, granted_Hz)};
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
