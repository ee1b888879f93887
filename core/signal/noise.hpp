/// \file
/// Standard deviation of a scan's noise, estimated from the trace itself, independent of slow motion in it.
///
///     double sigma = scan_noise(values, step / std::sqrt(12.0));
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "core/signal/sliding_window.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::signal {

/// Fourth differences of a stream, in blocks. They let pass (2 sin(π f/fs))⁴ of a sinusoid's amplitude, 1.6 %
/// at 17.5 scans a cycle, and √70 of white noise.
class FourthDifferences {
 public:
  static constexpr std::size_t kBlock = 64;      ///< Differences of a block.
  static constexpr double kVarianceGain = 70.0;  ///< Σ binomial(4,k)².

  /// \return true if block() is complete; the next difference begins a new one.
  bool add(double value) noexcept {
    last_.push(value);
    if (++seen_ < kValues) return false;
    const auto v = last_.values();
    const double fourth_difference = v[0] - 4.0 * v[1] + 6.0 * v[2] - 4.0 * v[3] + v[4];
    block_[in_block_++] = std::abs(fourth_difference);
    if (in_block_ < kBlock) return false;
    in_block_ = 0;
    return true;
  }
  /// To be called at a gap: no difference spans it. The block goes on.
  void gap() noexcept { seen_ = 0; }

  /// Absolute differences of the block; complete after an add() that returned true, until the next one.
  [[nodiscard]] const std::array<double, kBlock>& block() const noexcept { return block_; }

 private:
  static constexpr std::size_t kValues = 5;  ///< Of one difference.

  SlidingWindow<kValues> last_;
  std::size_t seen_ = 0;
  std::array<double, kBlock> block_{};
  std::size_t in_block_ = 0;
};

/// Estimates the standard deviation of white noise on single scans, from fourth differences: the median
/// absolute difference of each block of 64, over √70 · 0.6745 (its value for unit Gaussian noise), then the
/// median over the latest 256 blocks, so that spikes and slips have little effect. These are upper medians,
/// so the estimate is 2 % too large on white noise. O(1) memory and bounded time per scan; does not allocate.
class NoiseEstimator {
 public:
  /// \param floor  smallest estimate: the rounding noise of one A/D step, step/√12.
  explicit NoiseEstimator(double floor) noexcept;

  void add(double value) noexcept {
    if (differences_.add(value)) close_block();
  }
  /// To be called at a gap. The estimate is unchanged.
  void gap() noexcept { differences_.gap(); }

  /// Whether at least one block is complete, so that sigma() is measured.
  [[nodiscard]] bool known() const noexcept { return block_count_ > 0; }
  /// Standard deviation of one scan; the floor until known().
  [[nodiscard]] double sigma() const noexcept { return sigma_; }

 private:
  /// Medians of blocks kept: the latest 256, i.e. 47 s at 350 Hz.
  static constexpr std::size_t kBlocks = 256;

  void close_block() noexcept;

  double floor_;
  double sigma_;
  FourthDifferences differences_;
  std::array<double, kBlocks> medians_{};  ///< In the order of time; a ring buffer.
  std::array<double, kBlocks> sorted_{};   ///< The same in the order of size.
  std::size_t block_count_ = 0;
};

/// Fewest scans for an estimate: one block of fourth differences.
inline constexpr std::size_t kFewestScansForNoise = 68;

/// Upper median of a block: the higher of the two values in the middle. \param guess  a value near the
/// result, ≥ 0; it changes only the time.
[[nodiscard]] double block_median(const std::array<double, FourthDifferences::kBlock>& block,
                                  double guess) noexcept;
/// Standard deviation of a scan's noise, from the median absolute fourth difference: that over √70 · 0.6745.
[[nodiscard]] double sigma_of_median(double of_block) noexcept;

/// Standard deviation of the noise of a whole trace, as by NoiseEstimator but over all its blocks; allocates
/// 8 bytes for 64 values.
/// \return at least the floor; the floor if there are fewer than kFewestScansForNoise values.
/// \tparam Values  any range of double.
template <typename Values>
[[nodiscard]] double scan_noise(const Values& values, double floor) {
  FourthDifferences differences;
  std::vector<double> medians;
  for (const double value : values) {
    if (!differences.add(value)) continue;
    medians.push_back(block_median(differences.block(), medians.empty() ? 0.0 : medians.back()));
  }
  return medians.empty() ? floor : std::max(floor, sigma_of_median(median(medians)));
}

/// Resolution of a trace whose converter is unknown: its smallest non-zero step between consecutive values; 0
/// if it is constant or has fewer than two values. \tparam Values  any range of double.
template <typename Values>
[[nodiscard]] double smallest_step(const Values& values) {
  double smallest = 0.0;
  double before = std::numeric_limits<double>::quiet_NaN();
  for (const double value : values) {
    const double step = std::abs(value - before);
    if (step > 0.0 && (smallest == 0.0 || step < smallest)) smallest = step;
    before = value;
  }
  return smallest;
}

}  // namespace stickslip::signal
