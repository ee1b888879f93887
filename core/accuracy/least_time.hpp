/// \file
/// Computing time of a function, without disturbances.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/base/clock.hpp"

namespace stickslip::accuracy {

/// Shortest time of several runs of `work`, since disturbances only add to it. Stops when at least three runs
/// add up to 20 ms, or fewer to 0.3 s, or after a run during which the clock stood still.
/// \return ns, ≥ 1.
template <typename Work>
[[nodiscard]] std::int64_t least_time_ns(const base::Clock& clock, const Work& work) {
  constexpr std::int64_t kEnough_ns = 20'000'000;
  // At least three runs, since a single slow one may have been disturbed, unless they take too long.
  constexpr int kFewestRuns = 3;
  constexpr std::int64_t kTooLong_ns = 300'000'000;
  std::int64_t least_ns = std::numeric_limits<std::int64_t>::max();
  int runs = 0;
  for (std::int64_t sum_ns = 0; sum_ns < kEnough_ns || (runs < kFewestRuns && sum_ns < kTooLong_ns);) {
    const std::int64_t start_ns = clock.monotonic_ns();
    work();
    ++runs;
    // A clock that stands still (in tests) must not keep us for ever.
    const std::int64_t taken_ns = clock.monotonic_ns() - start_ns;
    least_ns = std::max<std::int64_t>(std::min(least_ns, taken_ns), 1);
    if (taken_ns <= 0) break;
    sum_ns += taken_ns;
  }
  return least_ns;
}

}  // namespace stickslip::accuracy
