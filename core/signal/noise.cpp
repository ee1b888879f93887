#include "core/signal/noise.hpp"

#include <algorithm>
#include <cmath>

#include "core/signal/statistics.hpp"

namespace stickslip::signal {
namespace {

/// Median absolute deviation of a unit Gaussian.
constexpr double kGaussianMad = 0.6744897501960817;
/// √70: gain of the fourth difference for white noise.
constexpr double kFourthDifferenceGain = 8.366600265340756;

}  // namespace

NoiseEstimator::NoiseEstimator(double floor) noexcept : floor_(floor), sigma_(floor) {}

void NoiseEstimator::add(double value) noexcept {
  std::rotate(last_.begin(), last_.begin() + 1, last_.end());
  last_.back() = value;
  if (++seen_ < last_.size()) return;
  const double fourth_difference = last_[0] - 4.0 * last_[1] + 6.0 * last_[2] - 4.0 * last_[3] + last_[4];
  block_[in_block_++] = std::abs(fourth_difference);
  if (in_block_ == kBlock) close_block();
}

void NoiseEstimator::close_block() noexcept {
  medians_[block_count_ % kBlocks] = median(block_);
  ++block_count_;
  in_block_ = 0;
  std::array<double, kBlocks> sorted = medians_;
  const std::span<double> filled{sorted.data(), std::min(block_count_, kBlocks)};
  sigma_ = std::max(floor_, median(filled) / (kGaussianMad * kFourthDifferenceGain));
}

}  // namespace stickslip::signal
