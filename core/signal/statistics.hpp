/// \file
/// Order statistics that every part of the detector shares.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace stickslip::signal {

/// Standard deviation of rounding to steps of one: 1/√12.
inline constexpr double kRoundingSigma = 0.28867513459481287;

/// Upper median: of an even number of values the higher of the two in the middle. Does not allocate.
/// \param values  not empty; reordered.
[[nodiscard]] inline double median(std::span<double> values) noexcept {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Mean of any number of values, without a large sum: its error stays below some ε of the largest value,
/// however many there are. [Welford, Technometrics 4(3):419–420, 1962]
struct RunningMean {
  double mean = 0.0;
  double count = 0.0;  ///< A double counts exactly up to 2⁵³.

  void add(double value) noexcept {
    count += 1.0;
    mean += (value - mean) / count;
  }
};

}  // namespace stickslip::signal
