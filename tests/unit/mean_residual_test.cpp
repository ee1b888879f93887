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
    mean.begin_slip();
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

TEST(MeanResidual, CountsNoMeanOfFewSlipsAndNoSpike) {
  MeanResidual few;
  for (int slip = 0; slip < 3; ++slip) {
    few.begin_slip();
    few.add(0.2, 5.0);
    few.add(0.2, 5.0);
  }
  EXPECT_EQ(few.freedom(), 0.0);
  EXPECT_EQ(few.square(), 0.0);
  EXPECT_EQ(few.z(1000.0), 0.0);
  EXPECT_EQ(few.birge_ratio(), 1.0);
  few.begin_slip();
  few.add(0.2, 1000.0);  // Counts as 3.
  EXPECT_EQ(few.chi_squared(), 63.0);
  few.add(-0.51, 1.0);
  few.add(1.0, 1.0);
  EXPECT_EQ(few.count(), 7.0);
}

TEST(MeanResidual, OfTwoSectionsIsThatOfAllSlips) {
  const auto law = [](double periods) { return std::sin(30.0 * periods); };
  MeanResidual both = residuals(50, 26, law);
  const MeanResidual one = both;
  both.add(one);
  EXPECT_NEAR(both.chi_squared(), 2.0 * one.chi_squared(), 1e-9);
  EXPECT_EQ(both.count(), 2.0 * one.count());
}

// Noise exceeds 2.326 in 1 % of the draws, and what repeats scatters by the error that is told.
TEST(MeanResidual, ErrorsAreThoseOfNoise) {
  constexpr int kDraws = 2000;
  constexpr double kMany = 1e12;  // σ is known.
  std::mt19937_64 random{kSeed};
  std::normal_distribution<double> noise;
  int beyond = 0;
  double squares = 0.0;
  double error = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    MeanResidual quiet;
    MeanResidual ringing;
    double mean_square = 0.0;
    for (int slip = 0; slip < 20; ++slip) {
      quiet.begin_slip();
      ringing.begin_slip();
      for (int scan = 0; scan < 32; ++scan) {
        const double periods = -0.5 + 1.5 * (0.5 + scan) / 32.0;
        const double z = noise(random);
        const double swing = 0.5 * std::sin(30.0 * periods);
        quiet.add(periods, z);
        ringing.add(periods, z + swing);
        mean_square += swing * swing / (20.0 * 32.0);
      }
    }
    beyond += quiet.z(kMany) > 2.326 ? 1 : 0;
    const double off = ringing.square() - mean_square;
    squares += off * off / kDraws;
    error += ringing.error_of_square(kMany) / kDraws;
  }
  EXPECT_NEAR(beyond, 0.01 * kDraws, 4.0 * std::sqrt(0.01 * kDraws));
  EXPECT_NEAR(std::sqrt(squares), error, 0.1 * error);
}

}  // namespace
}  // namespace stickslip::analysis
