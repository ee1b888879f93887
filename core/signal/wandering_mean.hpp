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

/// Mean of a sequence of values, and its standard error. The values are taken as white noise, or as an
/// Ornstein–Uhlenbeck process with white noise: covariance of values i and j
/// V = (1 − w) e^(−|i−j|/τ) + w δ_ij, in units of the variance. The square of the error is the average over w
/// and τ, weighted by their posterior probabilities [Gelman et al., Bayesian Data Analysis, 3rd ed., 2013,
/// section 7.6]. White noise has four fifths of the prior, so that independent values have the textbook error
/// √(variance/n) but for a few per cent; the error is never below that. From kMost values on, neighbours are
/// averaged, so that memory and time are bounded. Never allocates.
class WanderingMean {
 public:
  static constexpr std::size_t kMost = 512;  ///< Values, or means of neighbours, that are stored.

  void add(double value) noexcept;
  [[nodiscard]] double count() const noexcept { return values_.count; }
  [[nodiscard]] double mean() const noexcept { return values_.mean; }
  /// Variance of the values, with divisor n − 1; 0 for fewer than two.
  [[nodiscard]] double variance() const noexcept { return values_.variance(); }
  /// Standard error of mean(); the textbook error for fewer than eight values, 0 for fewer than two.
  [[nodiscard]] double error_of_mean() const noexcept;

 private:
  RunningVariance values_;
  std::array<double, kMost> blocks_{};  ///< Means of block_size_ neighbours each.
  std::size_t block_count_ = 0;
  std::size_t block_size_ = 1;
  RunningMean block_;  ///< The one that is not complete.
};

}  // namespace stickslip::signal
