#include "core/analysis/pooled_slips.hpp"

#include <cmath>

namespace stickslip::analysis {
namespace {

/// Mean over all of sum(test)/count(test), with the error of a ratio of sums over the tests that have some.
/// \param absence  reason if none has.
Estimate ratio(std::span<const SlipSums> tests, double SlipSums::*sum, double SlipSums::*count,
               const char* absence) {
  double all_sum = 0.0;
  double all_count = 0.0;
  double n = 0.0;
  for (const SlipSums& test : tests) {
    all_sum += test.*sum;
    all_count += test.*count;
    if (test.*count > 0.0) n += 1.0;
  }
  if (!(all_count > 0.0)) return Estimate::none(absence);
  const double mean = all_sum / all_count;
  if (n < 2.0) return Estimate::of(mean);
  double squares = 0.0;
  for (const SlipSums& test : tests) squares += std::pow(test.*sum - mean * test.*count, 2);
  return Estimate::of(mean, std::sqrt(squares * n / (n - 1.0)) / all_count);
}

}  // namespace

PooledDeltaMu pool_slips(std::span<const SlipSums> tests) {
  PooledDeltaMu pooled;
  pooled.mean = ratio(tests, &SlipSums::sum, &SlipSums::count, "no slip after the first with an S - K");
  pooled.captured_mean = ratio(tests, &SlipSums::captured_sum, &SlipSums::captured_count,
                               "no captured slip after the first with an S - K");
  double n = 0.0;
  double squares = 0.0;
  for (const SlipSums& test : tests) {
    if (!(test.count > 0.0)) continue;
    ++pooled.test_count;
    n += test.count;
    pooled.escaped_count += static_cast<std::size_t>(test.escaped_count);
    squares += test.square_sum + test.count * std::pow(test.sum / test.count - *pooled.mean.value, 2);
  }
  pooled.slip_count = static_cast<std::size_t>(n);
  if (n < 2.0) {
    pooled.scatter = Estimate::none("fewer than two slips to compare");
    return pooled;
  }
  const double sd = std::sqrt(squares / (n - 1.0));
  pooled.scatter = Estimate::of(sd, sd / std::sqrt(2.0 * (n - 1.0)));
  return pooled;
}

PooledDeltaMu pool_delta_mu(std::span<const std::vector<detect::Cycle>> tests, bool with_first) {
  std::vector<SlipSums> sums;
  sums.reserve(tests.size());
  for (const std::vector<detect::Cycle>& cycles : tests) sums.push_back(slip_sums(cycles, with_first));
  return pool_slips(sums);
}

}  // namespace stickslip::analysis
