#include "core/friction/replicates.hpp"

#include <cmath>

namespace stickslip::friction {
namespace {

/// Of one test, or of all.
struct Sums {
  double sum = 0.0;
  double count = 0.0;
};

bool counts(const Cycle& cycle, bool with_first) {
  return std::isfinite(cycle.delta_mu) && (with_first || (cycle.flags & kCycleIsFirst) == 0);
}

/// Mean over all, with the error of a ratio of sums over tests.
Estimate ratio(const std::vector<Sums>& tests) {
  Sums all;
  for (const Sums& test : tests) {
    all.sum += test.sum;
    all.count += test.count;
  }
  if (!(all.count > 0.0)) return Estimate::none("no slip with an S - K");
  const double mean = all.sum / all.count;
  const auto n = static_cast<double>(tests.size());
  if (n < 2.0) return Estimate::of(mean);
  double squares = 0.0;
  for (const Sums& test : tests) squares += std::pow(test.sum - mean * test.count, 2);
  return Estimate::of(mean, std::sqrt(squares * n / (n - 1.0)) / all.count);
}

}  // namespace

PooledDeltaMu pool_delta_mu(std::span<const std::vector<Cycle>> tests, bool with_first) {
  PooledDeltaMu pooled;
  std::vector<Sums> all;
  std::vector<Sums> captured;
  for (const std::vector<Cycle>& cycles : tests) {
    Sums of_all;
    Sums of_captured;
    for (std::size_t i = 0; i < cycles.size(); ++i) {
      const Cycle& cycle = cycles[i];
      if (!counts(cycle, with_first)) continue;
      of_all.sum += cycle.delta_mu;
      of_all.count += 1.0;
      ++pooled.slip_count;
      if ((cycle.flags & kCycleCaptured) != 0) {
        of_captured.sum += cycle.delta_mu;
        of_captured.count += 1.0;
      } else if (i + 1 < cycles.size()) {
        ++pooled.escaped_count;  // What the last slip did nobody has seen.
      }
    }
    if (of_all.count > 0.0) all.push_back(of_all);
    if (of_captured.count > 0.0) captured.push_back(of_captured);
  }
  pooled.mean = ratio(all);
  pooled.captured_mean = ratio(captured);
  if (pooled.slip_count < 2) {
    pooled.scatter = Estimate::none("fewer than two slips to compare");
    return pooled;
  }
  const auto n = static_cast<double>(pooled.slip_count);
  double squares = 0.0;
  for (const std::vector<Cycle>& cycles : tests) {
    for (const Cycle& cycle : cycles) {
      if (counts(cycle, with_first)) squares += std::pow(cycle.delta_mu - *pooled.mean.value, 2);
    }
  }
  const double sd = std::sqrt(squares / (n - 1.0));
  pooled.scatter = Estimate::of(sd, sd / std::sqrt(2.0 * (n - 1.0)));
  return pooled;
}

}  // namespace stickslip::friction
