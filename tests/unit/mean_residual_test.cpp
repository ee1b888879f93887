// What repeats in each slip is told from noise: its size, and the frequency at which it swings.

#include "core/analysis/mean_residual.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace stickslip::analysis {
namespace {

constexpr unsigned kSeed = 20261127;

/// So many slips of so many scans each, from half a period before the onset to one after it.
template <typename Law>
MeanResidual residuals(int slips, int scans, const Law& law) {
  std::mt19937_64 random{kSeed};
  std::normal_distribution<double> noise;
  std::uniform_real_distribution<double> phase;
  MeanResidual mean;
  for (int slip = 0; slip < slips; ++slip) {
    const double first = phase(random);
    for (int scan = 0; scan < scans; ++scan) {
      const double periods = -0.5 + 1.5 * (first + scan) / scans;
      mean.add(periods, law(periods) + noise(random));
    }
  }
  return mean;
}

TEST(MeanResidual, OfNoiseIsThatOfItsMeans) {
  const MeanResidual mean = residuals(400, 32, [](double) { return 0.0; });
  EXPECT_EQ(mean.freedom(), 64.0);
  EXPECT_EQ(mean.count(), 400.0 * 32.0);
  // χ² of 64 degrees: 64 ± √128; 4 standard errors.
  EXPECT_NEAR(mean.chi_squared(), 64.0, 4.0 * std::sqrt(128.0));
  EXPECT_NEAR(mean.square(), 0.0, 4.0 * std::sqrt(128.0) / mean.count());
  EXPECT_LT(mean.birge_ratio(), 1.0 + 2.0 * std::sqrt(2.0 / 64.0));
}

TEST(MeanResidual, OfARingingTransducerHasItsFrequency) {
  constexpr double kSize = 0.5;
  for (const double frequency : {4.1, 6.3, 11.0}) {
    const MeanResidual mean = residuals(100, 26, [&](double periods) {
      return periods < 0.0 ? 0.0 : kSize * std::sin(2.0 * std::numbers::pi * frequency * periods);
    });
    // Two thirds of the scans, with half the square of the size; a bin averages some of a swing away.
    const double averaged = std::pow(
        std::sin(frequency * std::numbers::pi * 1.5 / 64.0) / (frequency * std::numbers::pi * 1.5 / 64.0), 2);
    EXPECT_NEAR(mean.square(), 2.0 / 3.0 * 0.5 * kSize * kSize * averaged, 0.02) << frequency;
    EXPECT_NEAR(mean.birge_ratio(), std::sqrt(1.0 + mean.square() * mean.count() / mean.freedom()), 1e-9);
    ASSERT_TRUE(mean.swing()) << frequency;
    // A swing is a period long: half of a line's width.
    EXPECT_NEAR(*mean.swing(), frequency, 0.3);
  }
}

TEST(MeanResidual, OfAGradualBeginSwingsAtNoFrequency) {
  const MeanResidual mean =
      residuals(400, 26, [](double periods) { return std::exp(-std::abs(periods) / 0.06); });
  EXPECT_GT(mean.birge_ratio(), 2.0);  // 2.9 by the integral of its square, 0.06 periods.
  EXPECT_FALSE(mean.swing());
}

TEST(MeanResidual, CountsNoMeanOfFewScansAndNoSpike) {
  MeanResidual few;
  for (int i = 0; i < 3; ++i) few.add(0.2, 5.0);
  EXPECT_EQ(few.freedom(), 0.0);
  EXPECT_EQ(few.square(), 0.0);
  EXPECT_EQ(few.birge_ratio(), 1.0);
  few.add(0.2, 1000.0);  // Counts as 3.
  EXPECT_EQ(few.chi_squared(), 36.0);
  few.add(-0.51, 1.0);
  few.add(1.0, 1.0);
  EXPECT_EQ(few.count(), 4.0);
}

}  // namespace
}  // namespace stickslip::analysis
