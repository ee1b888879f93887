#include "core/daq/rate_meter.hpp"

#include <algorithm>
#include <cmath>

namespace stickslip::daq {

ScanIndex first_scan_after(const Continuation& from, std::int64_t now_ns) noexcept {
  const double elapsed_s = 1e-9 * static_cast<double>(now_ns - from.anchor.monotonic_ns);
  const ScanIndex by_the_clock = from.anchor.scan + std::llround(elapsed_s * from.scan_rate_Hz) + 1;
  return std::max(from.end + 1, by_the_clock);
}

void RateMeter::observe(const ScanBlock& block) noexcept {
  end_ = block.end();
  last_ = ClockAnchor{end_ - 1, block.stamp.monotonic_ns, block.stamp.realtime_ns};
  if (const auto picked = picker_.observe(block); picked && fit_.add(*picked)) latest_ = picked;
}

void RateMeter::started(ScanIndex first, std::int64_t now_ns) noexcept {
  restarted();
  end_ = first;
  latest_ = ClockAnchor{first - 1, now_ns, 0};
}

void RateMeter::restarted() noexcept {
  if (const auto last = picker_.flush()) fit_.add(*last);
  fit_.begin_segment();
  latest_.reset();
}

std::optional<Continuation> RateMeter::continuation() const noexcept {
  const auto prompt = latest_ ? latest_ : picker_.best();
  const auto anchor = prompt ? prompt : last_;
  if (!anchor) return std::nullopt;
  const auto rate = fit_.estimate();
  const bool usable = rate && rate->standard_error_Hz < kUsableRelativeError * rate->rate_Hz;
  return Continuation{end_, *anchor, usable ? rate->rate_Hz : granted_Hz_};
}

std::optional<double> RateMeter::lateness_ns(const ScanBlock& block) const noexcept {
  if (!latest_ || block.count == 0) return std::nullopt;
  return picker_.lateness_ns({block.end() - 1, block.stamp.monotonic_ns, 0}, *latest_);
}

}  // namespace stickslip::daq
