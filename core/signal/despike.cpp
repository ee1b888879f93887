#include "core/signal/despike.hpp"

#include <algorithm>
#include <cmath>

namespace stickslip::signal {
namespace {

/// 1/0.6745: a Gaussian's standard deviation over its median absolute deviation.
constexpr double kMadToSigma = 1.482602218505602;
/// Hampel's usual three scaled deviations.
constexpr double kDeviations = 3.0;
/// Noise alone, with the scatter of the median beside it, passes five standard deviations in at most six
/// of a million scans.
constexpr double kNoiseSigmas = 5.0;

}  // namespace

DespikedScan Despiker::judge(std::size_t position, double sigma) const noexcept {
  // At the ends of the trace the window is what there is, but never fewer than three.
  const double value = window_[position];
  if (size_ < 3) return {value, false};
  std::array<double, kWidth> sorted = window_;
  const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(size_);
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(size_ / 2);
  std::nth_element(sorted.begin(), middle, end);
  const double median = *middle;
  for (auto entry = sorted.begin(); entry != end; ++entry) *entry = std::abs(*entry - median);
  std::nth_element(sorted.begin(), middle, end);
  const double limit = std::max(kDeviations * kMadToSigma * *middle, kNoiseSigmas * sigma);
  if (std::abs(value - median) > limit) return {median, true};
  return {value, false};
}

std::optional<DespikedScan> Despiker::add(double value, double sigma) noexcept {
  if (size_ == kWidth) {
    std::rotate(window_.begin(), window_.begin() + 1, window_.end());
    window_.back() = value;
    return judge(kDelay, sigma);
  }
  window_[size_++] = value;
  if (size_ <= kDelay) return std::nullopt;
  // The first scans have no two neighbours on the left: they are judged as the window fills.
  return judge(judged_++, sigma);
}

std::optional<DespikedScan> Despiker::flush(double sigma) noexcept {
  if (judged_ >= size_) {
    size_ = 0;
    judged_ = 0;
    return std::nullopt;
  }
  return judge(judged_++, sigma);
}

}  // namespace stickslip::signal
