#include "core/signal/noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace stickslip::signal {
namespace {

/// Median absolute deviation of a unit Gaussian.
constexpr double kGaussianMad = 0.6744897501960817;
/// √FourthDifferences::kVarianceGain
constexpr double kFourthDifferenceGain = 8.366600265340756;

/// Relative distance of a block's median from that of all blocks that is hardly ever exceeded: two standard
/// deviations, each √(1/4/64)/0.636 = 0.098 σ or 15 % of the median.
constexpr double kNearly = 0.3;

}  // namespace

// nth_element stumbles over noise at every second comparison, and parting the values at known levels does
// not.
double block_median(const std::array<double, FourthDifferences::kBlock>& block, double guess) noexcept {
  constexpr std::size_t kSize = FourthDifferences::kBlock;
  const double from = (1.0 - kNearly) * guess;
  const double to = (1.0 + kNearly) * guess;
  std::array<double, kSize> below;
  std::array<double, kSize> near;
  std::array<double, kSize> above;
  std::size_t below_count = 0;
  std::size_t near_count = 0;
  std::size_t above_count = 0;
  for (const double value : block) {
    // Written to all, kept by one.
    below[below_count] = near[near_count] = above[above_count] = value;
    const std::size_t is_below = value < from ? 1 : 0;
    const std::size_t is_above = value > to ? 1 : 0;
    below_count += is_below;
    above_count += is_above;
    near_count += 1 - is_below - is_above;
  }
  const auto ranked = [](std::array<double, kSize>& part, std::size_t count, std::size_t rank) {
    const auto middle = part.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(part.begin(), middle, part.begin() + static_cast<std::ptrdiff_t>(count));
    return *middle;
  };
  constexpr std::size_t kRank = kSize / 2;
  if (kRank < below_count) return ranked(below, below_count, kRank);
  if (kRank < below_count + near_count) return ranked(near, near_count, kRank - below_count);
  return ranked(above, above_count, kRank - below_count - near_count);
}

double sigma_of_median(double of_block) noexcept { return of_block / (kGaussianMad * kFourthDifferenceGain); }

NoiseEstimator::NoiseEstimator(double floor) noexcept : floor_(floor), sigma_(floor) {}

void NoiseEstimator::close_block() noexcept {
  const double typical = block_count_ == 0 ? 0.0 : sorted_[std::min(block_count_, kBlocks) / 2];
  const double newest = block_median(differences_.block(), typical);
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
  const std::size_t filled = std::min(block_count_, kBlocks);
  sigma_ = std::max(floor_, sigma_of_median(sorted_[filled / 2]));
}

}  // namespace stickslip::signal
