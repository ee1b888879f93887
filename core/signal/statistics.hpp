/// \file
/// Medians, and running means and variances.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace stickslip::signal {

/// Standard deviation of rounding to steps of one: 1/√12.
inline constexpr double kRoundingSigma = 0.28867513459481287;

/// Upper median: of an even number of values the higher of the two in the middle. Does not allocate.
/// \param values  not empty, no NaN; reordered.
[[nodiscard]] inline double median(std::span<double> values) noexcept {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Largest number of values that nth_of() copies and sorts; of more it first finds the bits with which the
/// answer begins, in constant memory.
inline constexpr std::size_t kMostSorted = std::size_t{1} << 16U;

/// The value at a place of value(0) … value(count − 1) in rising order. Each is evaluated once, or two to
/// four times if count > kMostSorted. \param place  from 0, < count. \param value  no NaN.
template <typename Value>
[[nodiscard]] double nth_of(std::size_t count, std::size_t place, const Value& value) {
  // Doubles rise with their bits; those below zero are turned round.
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63U;
  const auto rank_of = [](double number) {
    const auto bits = std::bit_cast<std::uint64_t>(number);
    return (bits & kSign) != 0 ? ~bits : bits | kSign;
  };
  constexpr unsigned kDigit = 16;  // Bits found in one walk over the values.
  constexpr std::uint64_t kDigits = std::uint64_t{1} << kDigit;
  std::uint64_t answer = 0;
  unsigned unknown = 64;      // Its last bits.
  std::size_t alike = count;  // Values that begin with the bits known.
  const auto begins_alike = [&](double number) {
    return unknown == 64 || ((rank_of(number) ^ answer) >> unknown) == 0;
  };
  while (alike > kMostSorted && unknown > 0) {
    std::vector<std::size_t> counts(kDigits);
    const unsigned shift = unknown - kDigit;
    for (std::size_t i = 0; i < count; ++i) {
      const double number = value(i);
      if (begins_alike(number)) ++counts[(rank_of(number) >> shift) % kDigits];
    }
    std::uint64_t digit = 0;
    for (; place >= counts[digit]; ++digit) place -= counts[digit];
    answer |= digit << shift;
    alike = counts[digit];
    unknown = shift;
  }
  if (unknown == 0) return std::bit_cast<double>((answer & kSign) != 0 ? answer & ~kSign : ~answer);
  std::vector<double> values;
  values.reserve(alike);
  for (std::size_t i = 0; i < count; ++i) {
    const double number = value(i);
    if (begins_alike(number)) values.push_back(number);
  }
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(place);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// Upper median of value(0) … value(count − 1), by nth_of(). \param count  > 0.
template <typename Value>
[[nodiscard]] double median_of(std::size_t count, const Value& value) {
  return nth_of(count, count / 2, value);
}

/// Running mean. Its error is a few ε of the largest value, whatever the number of values. [Welford,
/// Technometrics 4(3):419–420, 1962]
struct RunningMean {
  double mean = 0.0;
  double count = 0.0;  ///< A double counts exactly up to 2⁵³.

  void add(double value) noexcept {
    count += 1.0;
    mean += (value - mean) / count;
  }
};

/// Running mean and variance.
struct RunningVariance {
  double mean = 0.0;
  double count = 0.0;
  double square_sum = 0.0;  ///< Of the differences from the mean.

  void add(double value) noexcept {
    count += 1.0;
    const double off = value - mean;
    mean += off / count;
    square_sum += off * (value - mean);
  }
  /// Variance with divisor n − 1; 0 for fewer than two values.
  [[nodiscard]] double variance() const noexcept { return count > 1.0 ? square_sum / (count - 1.0) : 0.0; }
  /// Standard error of the mean; 0 for one value. Requires at least one.
  [[nodiscard]] double error_of_mean() const noexcept { return std::sqrt(variance() / count); }
};

}  // namespace stickslip::signal
