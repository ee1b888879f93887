#include "core/signal/despike.hpp"

#include <algorithm>
#include <array>
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
inline double median_of_five(double a, double b, double c, double d, double e) noexcept {
  const double low = std::max(std::min(a, b), std::min(c, d));   // The two outermost of four …
  const double high = std::min(std::max(a, b), std::max(c, d));  // … cannot be in the middle of five.
  const double first = std::min(low, high);
  const double second = std::max(low, high);
  return std::max(first, std::min(second, e));
}

/// Upper median.
double median_of_few(std::array<double, 2 * kReach + 1> values, std::size_t size) noexcept {
  if (size == values.size()) return median_of_five(values[0], values[1], values[2], values[3], values[4]);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(size / 2);
  std::nth_element(values.begin(), middle, values.begin() + static_cast<std::ptrdiff_t>(size));
  return *middle;
}

/// Hampel's test of a value among four neighbours by their median. Three scaled median absolute deviations
/// are less than its own deviation exactly where those of three neighbours are: no second median is needed.
inline bool stands_out(double value, double median, double a, double b, double c, double d) noexcept {
  const double deviation = std::abs(value - median);
  const auto within = [&](double other) {
    return kDeviations * kMadToSigma * std::abs(other - median) < deviation ? 1 : 0;
  };
  return within(a) + within(b) + within(c) + within(d) >= 3;
}

/// Hampel's test of a value among its neighbours, with it at least three. \param value  replaced if it is a
/// spike.
DespikedScan hampel(double& value, std::span<const double> neighbours, double sigma) noexcept {
  const double noise_limit = kNoiseSigmas * sigma;
  std::array<double, 2 * kReach + 1> near{};
  std::copy(neighbours.begin(), neighbours.end(), near.begin());
  const double median = median_of_few(near, neighbours.size());
  if (!(std::abs(value - median) > noise_limit)) return {value, false};
  for (double& other : near) other = std::abs(other - median);
  const double limit =
      std::max(kDeviations * kMadToSigma * median_of_few(near, neighbours.size()), noise_limit);
  if (!(std::abs(value - median) > limit)) return {value, false};
  value = median;
  return {median, true};
}

}  // namespace

DespikedScan Despiker::judge_middle(double sigma) noexcept {
  const std::span<double, kWidth> window = window_.values();
  double& value = window[kDelay];
  if (!follows_a_cubic(window, sigma)) {
    if (const auto outlier = cubic_outlier(window, sigma)) {
      value -= *outlier;
      return {value, true};
    }
  }
  const double median = median_of_five(window[1], window[2], value, window[4], window[5]);
  // Nearly every scan ends here.
  if (!(std::abs(value - median) > kNoiseSigmas * sigma)) return {value, false};
  if (!stands_out(value, median, window[1], window[2], window[4], window[5])) return {value, false};
  value = median;
  return {median, true};
}

DespikedScan Despiker::judge_end(std::size_t position, double sigma) noexcept {
  // The window is what there is, but never fewer than three.
  const std::span<double> window = window_.values().last(size_);
  if (size_ < 3) return {window[position], false};
  const std::size_t begin = position > kReach ? position - kReach : 0;
  const std::size_t size = std::min(position + kReach + 1, size_) - begin;
  return hampel(window[position], window.subspan(begin, size), sigma);
}

std::optional<DespikedScan> Despiker::begin(double sigma) noexcept {
  ++size_;
  if (size_ <= kDelay) return std::nullopt;
  // The first scans have no three neighbours on the left: they are judged as the window fills.
  const std::size_t position = judged_++;
  return size_ == kWidth ? judge_middle(sigma) : judge_end(position, sigma);
}

std::optional<DespikedScan> Despiker::flush(double sigma) noexcept {
  if (judged_ >= size_) {
    size_ = 0;
    judged_ = 0;
    return std::nullopt;
  }
  return judge_end(judged_++, sigma);
}

}  // namespace stickslip::signal
