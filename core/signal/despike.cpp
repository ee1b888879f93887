#include "core/signal/despike.hpp"

#include <algorithm>
#include <cmath>

#include "core/signal/cubic_outlier.hpp"

namespace stickslip::signal {
namespace {

/// 1/0.6745: a Gaussian's standard deviation over its median absolute deviation.
constexpr double kMadToSigma = 1.482602218505602;
/// Hampel's usual three scaled deviations.
constexpr double kDeviations = 3.0;
/// Noise alone, with the scatter of the median beside it, passes five standard deviations in at most six
/// of a million scans.
constexpr double kNoiseSigmas = 5.0;
/// Neighbours on each side in Hampel's test.
constexpr std::size_t kReach = 2;

}  // namespace

DespikedScan Despiker::judge(std::size_t position, double sigma) noexcept {
  // At the ends of the trace the window is what there is, but never fewer than three.
  double& value = window_[position];
  if (size_ < 3) return {value, false};
  if (position == kDelay && size_ == kWidth) {
    if (const auto outlier = cubic_outlier(window_, sigma)) {
      value -= *outlier;
      return {value, true};
    }
  }
  const std::size_t begin = position > kReach ? position - kReach : 0;
  const std::size_t size = std::min(position + kReach + 1, size_) - begin;
  std::array<double, 2 * kReach + 1> sorted{};
  std::copy_n(window_.begin() + static_cast<std::ptrdiff_t>(begin), size, sorted.begin());
  const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(size);
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(size / 2);
  std::nth_element(sorted.begin(), middle, end);
  const double median = *middle;
  for (auto entry = sorted.begin(); entry != end; ++entry) *entry = std::abs(*entry - median);
  std::nth_element(sorted.begin(), middle, end);
  const double limit = std::max(kDeviations * kMadToSigma * *middle, kNoiseSigmas * sigma);
  if (!(std::abs(value - median) > limit)) return {value, false};
  value = median;
  return {median, true};
}

std::optional<DespikedScan> Despiker::add(double value, double sigma) noexcept {
  if (size_ == kWidth) {
    std::rotate(window_.begin(), window_.begin() + 1, window_.end());
    window_.back() = value;
    return judge(kDelay, sigma);
  }
  window_[size_++] = value;
  if (size_ <= kDelay) return std::nullopt;
  // The first scans have no three neighbours on the left: they are judged as the window fills.
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
