// Paper whose S − K differs by 30 % from slip to slip: each slip's own S − K is measured, also of the one
// that does not stick again, and replicates are pooled by cycle.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/support/scatter_trials.hpp"

namespace stickslip {
namespace {

constexpr int kTests = 200;

friction::PooledDeltaMu pool_and_print(double speed_in_per_min, const test::ScatterTrials& trials) {
  friction::PooledDeltaMu pooled = friction::pool_delta_mu(trials.cycles);
  const auto bias = [](const friction::Estimate& mean) {
    return 100.0 * (*mean.value / test::ScatterTrials::kDeltaMu - 1.0);
  };
  std::printf(
      "%2.0f in/min: rms error %.3f CV/sqrt(M); pooled %+.2f %% (standard error %.2f %%), captured slips "
      "alone "
      "%+.2f %%; %zu slips, %zu escaped, %d tests of %d without an S - K\n",
      speed_in_per_min, trials.rms_over_sampling(), bias(pooled.mean),
      100.0 * *pooled.mean.standard_error / test::ScatterTrials::kDeltaMu, bias(pooled.captured_mean),
      pooled.slip_count, pooled.escaped_count, trials.without_delta_mu(), kTests);
  return pooled;
}

/// What three standard errors of the simulation allow beyond 1 %.
double allowed_bias(const friction::PooledDeltaMu& pooled) {
  return 0.01 * test::ScatterTrials::kDeltaMu + 3.0 * *pooled.mean.standard_error;
}

TEST(ScatteredSlips, TheirMeanIsAsGoodAsTheirNumberAllows) {
  // An rms of n tests scatters by 1/√(2n) of itself.
  for (const double speed_in_per_min : {3.0, 6.0}) {
    const test::ScatterTrials trials{speed_in_per_min, kTests};
    const friction::PooledDeltaMu pooled = pool_and_print(speed_in_per_min, trials);
    EXPECT_EQ(trials.without_delta_mu(), 0);
    EXPECT_LT(trials.rms_over_sampling(), 1.2 * (1.0 + 3.0 / std::sqrt(2.0 * kTests)));
    EXPECT_NEAR(*pooled.mean.value, test::ScatterTrials::kDeltaMu, allowed_bias(pooled));
    // Of n slips a standard deviation scatters by about 1/√(2n), and a log-normal one by some more.
    EXPECT_NEAR(*pooled.scatter.value / test::ScatterTrials::kDeltaMu, test::ScatterTrials::kCv, 0.03);
  }
}

TEST(ScatteredSlips, TheOneThatEscapesCounts) {
  const test::ScatterTrials trials{12.0, kTests};
  const friction::PooledDeltaMu pooled = pool_and_print(12.0, trials);
  EXPECT_LE(trials.without_delta_mu(), kTests / 100);
  // S − K below 0.67 of its mean does not stick again at Q = 1.30: 11.6 % of a log-normal one.
  const double escaped = static_cast<double>(pooled.escaped_count) / static_cast<double>(pooled.slip_count);
  EXPECT_NEAR(escaped, 0.116, 3.0 * std::sqrt(0.116 * 0.884 / static_cast<double>(pooled.slip_count)));
  EXPECT_NEAR(*pooled.mean.value, test::ScatterTrials::kDeltaMu, allowed_bias(pooled));
  EXPECT_GT(*pooled.captured_mean.value, 1.02 * test::ScatterTrials::kDeltaMu)
      << "then pooling shows nothing";
}

}  // namespace
}  // namespace stickslip
