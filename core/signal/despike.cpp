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

/// Median of five by six comparisons [Knuth, TAOCP 3, 5.3.3]: no branch that noise could mislead.
double median_of_five(double a, double b, double c, double d, double e) noexcept {
  const double low = std::max(std::min(a, b), std::min(c, d));   // The two outermost of four …
  const double high = std::min(std::max(a, b), std::max(c, d));  // … cannot be in the middle of five.
  const double first = std::min(low, high);
  const double second = std::max(low, high);
  return std::max(first, std::min(second, e));
}

/// Upper median of the first `size` values.
double median_of_few(std::array<double, 2 * kReach + 1> values, std::size_t size) noexcept {
  if (size == values.size()) return median_of_five(values[0], values[1], values[2], values[3], values[4]);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(size / 2);
  std::nth_element(values.begin(), middle, values.begin() + static_cast<std::ptrdiff_t>(size));
  return *middle;
}

}  // namespace

DespikedScan Despiker::judge(std::size_t position, double sigma) noexcept {
  // At the ends of the trace the window is what there is, but never fewer than three.
  double& value = window_[position];
  if (size_ < 3) return {value, false};
  const double noise_limit = kNoiseSigmas * sigma;
  if (position == kDelay && size_ == kWidth) {
    const bool cubic = follows_a_cubic(window_, sigma);
    // Nearly every scan ends here.
    if (cubic && std::abs(value - median_of_five(window_[1], window_[2], value, window_[4], window_[5])) <=
                     noise_limit) {
      return {value, false};
    }
    if (!cubic) {
      if (const auto outlier = cubic_outlier(window_, sigma)) {
        value -= *outlier;
        return {value, true};
      }
    }
  }
  const std::size_t begin = position > kReach ? position - kReach : 0;
  const std::size_t size = std::min(position + kReach + 1, size_) - begin;
  std::array<double, 2 * kReach + 1> near{};
  std::copy_n(window_.begin() + static_cast<std::ptrdiff_t>(begin), size, near.begin());
  const double median = median_of_few(near, size);
  if (!(std::abs(value - median) > noise_limit)) return {value, false};
  for (std::size_t i = 0; i < size; ++i) near[i] = std::abs(near[i] - median);
  const double limit = std::max(kDeviations * kMadToSigma * median_of_few(near, size), noise_limit);
  if (!(std::abs(value - median) > limit)) return {value, false};
  value = median;
  return {median, true};
}

std::optional<DespikedScan> Despiker::add(double value, double sigma) noexcept {
  if (size_ == kWidth) {
    std::copy(window_.begin() + 1, window_.end(), window_.begin());
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
