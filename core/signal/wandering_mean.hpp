/// \file
/// Mean of values whose neighbours are correlated, with its standard error.
///
///     WanderingMean level;
///     for (const double value : values) level.add(value);
///     level.mean() ± level.error_of_mean();
#pragma once

#include <array>
#include <cstddef>

#include "core/signal/statistics.hpp"

namespace stickslip::signal {

/// The error follows from the long-run variance, by the initial positive sequence of autocovariances [Geyer,
/// Stat. Sci. 7(4):473–483, 1992, section 3.3]. It is never below that of independent values. From kMost
/// values on, neighbours are averaged, so that memory and time are bounded. Never allocates.
class WanderingMean {
 public:
  static constexpr std::size_t kMost = 512;

  void add(double value) noexcept;
  [[nodiscard]] double count() const noexcept { return values_.count; }
  [[nodiscard]] double mean() const noexcept { return values_.mean; }
  /// Of the values; divisor n − 1.
  [[nodiscard]] double variance() const noexcept { return values_.variance(); }
  /// Standard error of mean(). Requires at least one value.
  [[nodiscard]] double error_of_mean() const noexcept;

 private:
  RunningVariance values_;
  std::array<double, kMost> blocks_{};  ///< Means of block_size_ neighbours each.
  std::size_t block_count_ = 0;
  std::size_t block_size_ = 1;
  RunningMean block_;  ///< The one that is not complete.
};

}  // namespace stickslip::signal
