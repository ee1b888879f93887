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
  std::copy(last_.begin() + 1, last_.end(), last_.begin());
  last_.back() = value;
  if (++seen_ < last_.size()) return;
  const double fourth_difference = last_[0] - 4.0 * last_[1] + 6.0 * last_[2] - 4.0 * last_[3] + last_[4];
  block_[in_block_++] = std::abs(fourth_difference);
  if (in_block_ == kBlock) close_block();
}

void NoiseEstimator::close_block() noexcept {
  const double newest = median(block_);
  double& slot = medians_[block_count_ % kBlocks];
  const std::size_t before = std::min(block_count_, kBlocks);
  const auto begin = sorted_.begin();
  auto end = begin + static_cast<std::ptrdiff_t>(before);
  // In their order all the time: to sort them anew for each block would cost more than all else for its
  // scans.
  if (before == kBlocks) {
    const auto oldest = std::lower_bound(begin, end, slot);
    std::move(oldest + 1, end, oldest);
    --end;
  }
  const auto place = std::upper_bound(begin, end, newest);
  std::move_backward(place, end, end + 1);
  *place = newest;
  slot = newest;
  ++block_count_;
  in_block_ = 0;
  const std::size_t filled = std::min(block_count_, kBlocks);
  sigma_ = std::max(floor_, sorted_[filled / 2] / (kGaussianMad * kFourthDifferenceGain));
}

}  // namespace stickslip::signal
