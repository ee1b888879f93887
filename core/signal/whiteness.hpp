/// \file
/// Test of noise for whiteness. An estimate from neighbouring scans takes an oscillation of few scans a cycle
/// for noise.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/base/long_column.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::signal {

/// Whether the apparent noise contains an oscillation of three to nine scans a cycle.
///
/// Uses second differences, which remove drift and slow waves. Those of white noise are uncorrelated at lags
/// of three scans and more: the autocorrelation of n of them is 0 ± √(1.94/n) [Bartlett 1946, with −2/3 and
/// 1/6 at lags 1 and 2]. An oscillation gives a positive maximum after negative values, at the lag nearest to
/// its period and as high as its share of the power. The maximum must exceed one half and five standard
/// deviations. Differences are clipped at one and a half times their median magnitude, so that spikes cannot
/// mask an oscillation.
/// \tparam Values  any range of double.
/// \param floor  noise of a scan by rounding alone.
/// \return false also for fewer than 13 values, and if the noise is not above `floor`.
template <typename Values>
[[nodiscard]] bool hides_an_oscillation(const Values& values, double floor) {
  constexpr std::size_t kLags = 10;
  constexpr std::size_t kLongestPeriod = 9;
  constexpr double kClip = 1.5;
  constexpr double kShare = 0.5;
  constexpr double kSigmas = 5.0;
  constexpr double kBartlett = 1.94;  // 1 + 2 ((2/3)² + (1/6)²)
  constexpr double kGain = 1.652;     // √6 · 0.6745: the median of such differences of unit white noise.

  base::LongColumn<double> differences;
  std::array<double, 2> before{};
  std::size_t seen = 0;
  for (const double value : values) {
    if (seen++ >= before.size()) differences.push_back(value - 2.0 * before[1] + before[0]);
    before = {before[1], value};
  }
  const std::size_t count = differences.size();
  if (count <= kLags) return false;
  const base::LongColumn<double>& all = differences;
  const double typical = median_of(count, [&](std::size_t i) { return std::abs(all[i]); });
  if (!(typical > kGain * floor)) return false;

  std::array<double, kLags + 1> sum{};
  std::array<double, kLags + 1> last{};  // last[k]: k scans ago.
  for (const double difference : all) {
    std::move_backward(last.begin(), last.end() - 1, last.end());
    last[0] = std::clamp(difference, -kClip * typical, kClip * typical);
    for (std::size_t lag = 0; lag <= kLags; ++lag) sum[lag] += last[0] * last[lag];
  }
  const double enough = std::max(kShare, kSigmas * std::sqrt(kBartlett / static_cast<double>(count)));
  bool was_negative = false;
  for (std::size_t lag = 1; lag <= kLongestPeriod; ++lag) {
    const double correlation = sum[lag] / sum[0];
    const bool is_peak = sum[lag] >= sum[lag - 1] && sum[lag] >= sum[lag + 1];
    if (lag >= 3 && was_negative && is_peak && correlation > enough) return true;
    was_negative |= correlation < 0.0;
  }
  return false;
}

}  // namespace stickslip::signal
