/// \file
/// Is what looks like noise white? An oscillation of few scans a cycle passes for noise wherever that is
/// measured from neighbouring scans.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/base/long_column.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::signal {

/// An oscillation of three to nine scans a cycle is hidden in what was taken for noise.
///
/// Second differences are rid of drift and slow waves, and those of white noise know nothing of each other
/// from three scans on: with n of them their autocorrelation there is 0 ± √(1.94/n) [Bartlett 1946, with
/// −2/3 and 1/6 at one and two scans]. An oscillation makes it rise again after it was negative, to its share
/// of the power, at the scan nearest to its period: more than one half is asked for, and five standard
/// deviations. Differences count for no more than one and a half times their median, so that spikes hide
/// nothing. \tparam Values  any range of double. \param floor  differences that rounding alone makes, as
/// noise of a scan.
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
