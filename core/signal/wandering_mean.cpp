#include "core/signal/wandering_mean.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace stickslip::signal {
namespace {

/// Fewer autocovariances than this many values give tell nothing.
constexpr std::size_t kFewest = 8;

/// Autocovariance at a lag, divisor n [Priestley, Spectral Analysis and Time Series, 1981, (5.3.13)].
double autocovariance(std::span<const double> values, double mean, std::size_t lag) noexcept {
  double sum = 0.0;
  for (std::size_t i = lag; i < values.size(); ++i) sum += (values[i] - mean) * (values[i - lag] - mean);
  return sum / static_cast<double>(values.size());
}

/// Long-run variance over variance, at least 1.
double correlation_length_of(std::span<const double> values) noexcept {
  RunningMean mean;
  for (const double value : values) mean.add(value);
  const double variance = autocovariance(values, mean.mean, 0);
  if (values.size() < kFewest || !(variance > 0.0)) return 1.0;
  double sum = -variance;
  for (std::size_t lag = 0; lag + 1 < values.size(); lag += 2) {
    const double pair = autocovariance(values, mean.mean, lag) + autocovariance(values, mean.mean, lag + 1);
    if (!(pair > 0.0)) break;
    sum += 2.0 * pair;
  }
  return std::clamp(sum / variance, 1.0, 0.5 * static_cast<double>(values.size()));
}

}  // namespace

void WanderingMean::add(double value) noexcept {
  values_.add(value);
  block_.add(value);
  if (block_.count < static_cast<double>(block_size_)) return;
  blocks_[block_count_++] = block_.mean;
  block_ = {};
  if (block_count_ < kMost) return;
  block_count_ /= 2;
  block_size_ *= 2;
  for (std::size_t i = 0; i < block_count_; ++i) blocks_[i] = 0.5 * (blocks_[2 * i] + blocks_[2 * i + 1]);
}

double WanderingMean::error_of_mean() const noexcept {
  if (values_.count < 2.0) return 0.0;
  const std::span blocks = std::span{blocks_}.first(block_count_);
  RunningVariance of_blocks;
  for (const double block : blocks) of_blocks.add(block);
  const double length = correlation_length_of(blocks);
  const auto n = static_cast<double>(block_count_);
  // The values lie about their own mean, whose variance is missing in theirs.
  const double square = of_blocks.square_sum / n * length / (n - length);
  return std::max(std::sqrt(square), values_.error_of_mean());
}

}  // namespace stickslip::signal
