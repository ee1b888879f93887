#include "core/pipeline/unloaded_level.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "core/signal/statistics.hpp"

namespace stickslip::pipeline {
namespace {

/// Standard deviation over the median absolute deviation, of Gaussian noise.
constexpr double kSigmaOverMad = 1.4826;
/// Largest range of a quiet stretch's four medians, in standard errors; noise alone exceeds it once in about
/// 10 000 stretches.
constexpr double kMostSpreadErrors = 6.0;
/// A quiet stretch has at most kMostOutside of its scans farther than kBandSigmas from the median (spikes).
/// This test finds excursions shorter than half of a stretch, which affect neither the median nor the median
/// deviation.
constexpr double kBandSigmas = 4.0;
constexpr double kMostOutside = 0.05;
/// Smallest spread assumed, for traces without noise.
constexpr double kSmallestSpread = UnloadedLevel::kNearest / 10.0;
/// Limit of the scans in a stretch, since a file may claim any scan rate.
constexpr double kMostScans = 1e6;
/// Spread by rounding, in A/D steps: a level between two codes may be read as either.
constexpr double kRoundedSteps = 1.5;

}  // namespace

UnloadedLevel::UnloadedLevel(double scan_rate_Hz, double stretch_s, double step_coefficient)
    : smallest_spread_(std::max(kSmallestSpread, kRoundedSteps * step_coefficient)),
      quarter_(static_cast<std::size_t>(std::max(
          2.0,
          std::min(kMostScans, std::floor(stretch_s * scan_rate_Hz / static_cast<double>(kQuarters)))))) {}

void UnloadedLevel::clear() noexcept {
  filled_ = closed_ = 0;
  quiet_ = false;
  news_.reset();
}

void UnloadedLevel::add(double coefficient) {
  news_.reset();
  quarter_[filled_++] = coefficient;
  if (filled_ == quarter_.size()) close_quarter();
}

void UnloadedLevel::close_quarter() {
  filled_ = 0;
  const std::size_t at = closed_++ % kQuarters;
  const double middle = signal::median(quarter_);
  for (double& value : quarter_) value = std::abs(value - middle);
  const double sigma = kSigmaOverMad * signal::median(quarter_);
  const double band = std::max(smallest_spread_, kBandSigmas * sigma);
  outside_[at] =
      std::count_if(quarter_.begin(), quarter_.end(), [band](double deviation) { return deviation > band; });
  medians_[at] = middle;
  errors_[at] = sigma > kLargestNoise
                    ? -1.0
                    : sigma * std::sqrt(0.5 * std::numbers::pi / static_cast<double>(quarter_.size()));
  quiet_ = false;
  if (closed_ < kQuarters || *std::min_element(errors_.begin(), errors_.end()) < 0.0) return;
  const auto outside = std::accumulate(outside_.begin(), outside_.end(), std::ptrdiff_t{0});
  if (static_cast<double>(outside) > kMostOutside * static_cast<double>(kQuarters * quarter_.size())) return;
  const auto [low, high] = std::minmax_element(medians_.begin(), medians_.end());
  const double error = *std::max_element(errors_.begin(), errors_.end());
  quiet_ = *high - *low <= std::max(smallest_spread_, kMostSpreadErrors * error);
  if (quiet_) news_ = std::accumulate(medians_.begin(), medians_.end(), 0.0) / static_cast<double>(kQuarters);
}

bool UnloadedLevel::fits(double level) noexcept { return std::abs(level) <= kFarthest; }

bool UnloadedLevel::fits_after(double level, double largest, double before) noexcept {
  return fits(level) && level - before <= kUnloadedPart * (largest - before);
}

double UnloadedLevel::of_decisions(double level) noexcept {
  return std::abs(level) <= kNearest ? 0.0 : level;
}

}  // namespace stickslip::pipeline
