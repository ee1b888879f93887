#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/analysis/pooled_slips.hpp"

namespace stickslip::detect {
namespace {

Cycle slip(double delta_mu, unsigned flags) {
  Cycle cycle;
  cycle.delta_mu = delta_mu;
  cycle.flags = static_cast<std::uint8_t>(flags);
  return cycle;
}

constexpr unsigned kFirst = kCycleIsFirst | kCycleCaptured;

TEST(Replicates, EachSlipCountsOnceWhateverItsTest) {
  const double nan = std::nan("");
  const std::vector<std::vector<Cycle>> tests{
      {slip(9.0, kFirst), slip(0.06, kCycleCaptured), slip(0.02, 0), slip(nan, 0), slip(nan, 0)},
      {slip(9.0, kFirst), slip(0.05, kCycleCaptured), slip(0.07, kCycleCaptured), slip(0.05, 0)}};
  const analysis::PooledDeltaMu pooled = analysis::pool_delta_mu(tests);
  EXPECT_EQ(pooled.test_count, 2U);
  EXPECT_EQ(pooled.slip_count, 5U);
  EXPECT_EQ(pooled.escaped_count, 1U);  // The last of all was not seen to its end.
  EXPECT_NEAR(*pooled.mean.value, 0.25 / 5.0, 1e-15);
  EXPECT_NEAR(*pooled.captured_mean.value, 0.18 / 3.0, 1e-15);
  // Sums over tests less the mean times their slips: 0.08 − 0.10 and 0.17 − 0.15; n/(n − 1) = 2.
  EXPECT_NEAR(*pooled.mean.standard_error, std::sqrt(2.0 * (4e-4 + 4e-4)) / 5.0, 1e-15);
  EXPECT_NEAR(*pooled.scatter.value, std::sqrt((1e-4 + 9e-4 + 4e-4) / 4.0), 1e-15);
  EXPECT_EQ(analysis::pool_delta_mu(tests, true).slip_count, 7U);
}

TEST(Replicates, OneTestHasNoStandardErrorAndNoSlipNoMean) {
  const std::vector<std::vector<Cycle>> one{{slip(9.0, kFirst), slip(0.05, kCycleCaptured)}};
  EXPECT_FALSE(analysis::pool_delta_mu(one).mean.standard_error);
  EXPECT_FALSE(analysis::pool_delta_mu(one).scatter.value);
  const analysis::PooledDeltaMu none = analysis::pool_delta_mu({});
  EXPECT_FALSE(none.mean.value);
  EXPECT_EQ(none.mean.reason, "no slip after the first with an S - K");
  EXPECT_EQ(none.captured_mean.reason, "no captured slip after the first with an S - K");
}

}  // namespace
}  // namespace stickslip::detect
