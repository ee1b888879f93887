#include "core/signal/noise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "core/signal/whiteness.hpp"

namespace stickslip::signal {
namespace {

using std::numbers::pi;

/// The paper's tester: 350 scans a second of 20 Hz.
constexpr double kScansPerCycle = 17.5;
constexpr double kGaussianMad = 0.6744897501960817;

std::vector<double> white_noise(std::size_t count, double sigma, std::uint64_t seed) {
  std::mt19937_64 engine{seed};
  std::normal_distribution<double> normal{0.0, sigma};
  std::vector<double> values(count);
  for (double& value : values) value = normal(engine);
  return values;
}

double oscillation(std::size_t k, double amplitude) {
  return amplitude * std::sin(2.0 * pi * static_cast<double>(k) / kScansPerCycle);
}

TEST(Noise, FourthDifferenceLetsPassTwoSineToTheFourthOfAnOscillation) {
  const double amplitude = 80.0;
  std::vector<double> values(350 * 60);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = oscillation(k, amplitude);
  const double passed = amplitude * std::pow(2.0 * std::sin(pi / kScansPerCycle), 4);
  EXPECT_NEAR(passed / amplitude, 0.0163, 0.0001);
  // The median of |sin| is 1/√2 of its largest value; among 64 scans over 35 phases the median is
  // sharp to 0.1 of it (a step of one phase is π/35, times the slope 1.11 at the median).
  const double largest = passed / (kGaussianMad * std::sqrt(70.0));
  EXPECT_NEAR(scan_noise(values, 1e-12), largest / std::sqrt(2.0), 0.1 * largest);
}

TEST(Noise, FoundUnderAnOscillationOfEightySigma) {
  // Bias: the 33rd of 64 values is the quantile 33/65, +1.8 %; the oscillation adds (1.30 σ)²/2 to a
  // variance of 70 σ², +0.6 %. Scatter over 256 blocks: MAD 1.166/√16384, times √2.6 since
  // neighbouring differences are correlated, times √(π/2) for the median of medians: 1.9 %.
  // Together 2.4 % ± 4 · 1.9 %.
  const double sigma = 0.001;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    std::vector<double> values = white_noise(256 * 64 + 4, sigma, seed);
    for (std::size_t k = 0; k < values.size(); ++k) values[k] += 0.3 + oscillation(k, 80.0 * sigma);
    EXPECT_NEAR(scan_noise(values, 1e-9) / sigma, 1.024, 0.076) << seed;
  }
}

TEST(Noise, ConstantTraceHasTheNoiseOfItsFloor) {
  EXPECT_EQ(scan_noise(std::vector<double>(1000, 0.3), 1e-5), 1e-5);
}

TEST(Noise, StraightAndParabolicDriftAreNoNoise) {
  std::vector<double> values(1000);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto x = static_cast<double>(k);
    values[k] = 3.0 + 0.25 * x - 0.0625 * x * x;  // exact in binary: the differences are 0
  }
  EXPECT_EQ(scan_noise(values, 1e-9), 1e-9);
}

TEST(Noise, UnknownBeforeTheFirstBlockIsFull) {
  // 64 differences of five scans need 68 scans.
  const std::vector<double> values = white_noise(68, 1.0, 7);
  EXPECT_EQ(scan_noise(std::span{values}.first(67), 1e-9), 1e-9);
  EXPECT_EQ(scan_noise(std::vector<double>{}, 1e-9), 1e-9);
  EXPECT_GT(scan_noise(values, 1e-9), 0.3);
  NoiseEstimator estimator{1e-9};
  for (std::size_t k = 0; k < 67; ++k) estimator.add(values[k]);
  EXPECT_FALSE(estimator.known());
  estimator.add(values[67]);
  EXPECT_TRUE(estimator.known());
}

TEST(Noise, SpikesRaiseItOnlyByTheQuantileTheyOccupy) {
  // One spike in n scans spoils 5 of n differences. However high they are, the median becomes at most
  // the quantile 0.5/(1 − 5/n) of |z|: 0.717 at n = 100, 1.221 at n = 14 (25 spikes a second).
  // Against the same noise without spikes, so the common scatter drops out; 5 % for the rest of it.
  struct Case {
    std::size_t every;
    double quantile;
  };
  const std::vector<double> clean = white_noise(350 * 60, 1.0, 11);
  for (const auto& [every, quantile] : {Case{100, 0.717}, Case{14, 1.221}}) {
    std::vector<double> values = clean;
    for (std::size_t k = 3; k < values.size(); k += every) values[k] += 1e6;
    const double ratio = scan_noise(values, 1e-9) / scan_noise(clean, 1e-9);
    EXPECT_GE(ratio, 1.0);
    EXPECT_LE(ratio, 1.05 * quantile / kGaussianMad) << every;
  }
}

TEST(Noise, OfALongTraceIsThatOfAllOfIt) {
  // A motor is switched off for the last 50 s of 165 s at 350 Hz: 0.3 of the blocks are quiet.
  std::vector<double> values = white_noise(40'000, 1.0, 1);
  const std::vector<double> quiet = white_noise(17'500, 0.1, 2);
  values.insert(values.end(), quiet.begin(), quiet.end());
  // The median block is at the quantile (0.5 − 0.3)/0.7 of the loud ones, 0.57 standard deviations of 15 %
  // below their median.
  EXPECT_NEAR(scan_noise(values, 0.0), 1.0 - 0.57 * 0.15, 0.03);
}

TEST(Noise, DifferencesDoNotReachAcrossAGap) {
  // A level for each five scans: one difference each, exactly 0, if the gap is told.
  NoiseEstimator told{1e-9};
  NoiseEstimator untold{1e-9};
  for (int level = 0; level < 200; ++level) {
    told.gap();
    for (int k = 0; k < 5; ++k) {
      told.add(static_cast<double>(level * level));
      untold.add(static_cast<double>(level * level));
    }
  }
  EXPECT_TRUE(told.known());
  EXPECT_EQ(told.sigma(), 1e-9);
  EXPECT_GT(untold.sigma(), 1.0);
}

TEST(Noise, GapKeepsTheEstimate) {
  NoiseEstimator estimator{1e-9};
  for (const double value : white_noise(640, 1.0, 3)) estimator.add(value);
  const double before = estimator.sigma();
  estimator.gap();
  EXPECT_EQ(estimator.sigma(), before);
}

/// Calls visit(difference) for each of the first `blocks` blocks of f(0), f(1), …
template <typename F, typename Visit>
void for_each_difference(int blocks, const F& f, const Visit& visit) {
  FourthDifferences differences;
  for (std::size_t k = 0; blocks > 0; ++k) {
    if (!differences.add(f(static_cast<double>(k)))) continue;
    --blocks;
    for (const double difference : differences.block()) visit(difference);
  }
}

TEST(FourthDifferences, OfACubicAreZeroAndOfAFourthPowerTwentyFour) {
  for_each_difference(
      2, [](double t) { return 3.0 - 2.0 * t + 0.5 * t * t - t * t * t; },
      [](double difference) { EXPECT_EQ(difference, 0.0); });
  for_each_difference(
      2, [](double t) { return t * t * t * t; }, [](double difference) { EXPECT_EQ(difference, 24.0); });
}

TEST(FourthDifferences, LetPassTheFourthPowerOfTwiceTheSineOfHalfTheStep) {
  for (const double scans_per_cycle : {2.0, 4.0, kScansPerCycle, 100.0}) {
    double largest = 0.0;
    for_each_difference(
        40, [&](double t) { return std::cos(2.0 * pi * t / scans_per_cycle); },
        [&](double difference) { largest = std::max(largest, difference); });
    const double gain = std::pow(2.0 * std::sin(pi / scans_per_cycle), 4);
    EXPECT_NEAR(largest, gain, 2e-3 * gain + 1e-14) << scans_per_cycle;
  }
}

TEST(FourthDifferences, HaveSeventyTimesTheVarianceOfWhiteNoise) {
  constexpr int kBlocks = 1000;
  const std::vector<double> noise = white_noise(kBlocks * FourthDifferences::kBlock + 4, 1.0, 5);
  double sum = 0.0;
  for_each_difference(
      kBlocks, [&](double t) { return noise[static_cast<std::size_t>(t)]; },
      [&](double difference) { sum += difference * difference; });
  // Of 64 000 correlated squares; independent ones would be within 0.6 % of it.
  EXPECT_NEAR(sum / (kBlocks * FourthDifferences::kBlock), FourthDifferences::kVarianceGain, 2.0);
}

TEST(FourthDifferences, NoneSpansAGap) {
  FourthDifferences differences;
  std::size_t scans = 0;
  const auto add = [&](double value) {
    ++scans;
    return differences.add(value);
  };
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(add(0.0));
  differences.gap();
  while (!add(1.0)) {
  }
  for (const double difference : differences.block()) EXPECT_EQ(difference, 0.0);
  // Four scans on each side begin a difference only.
  EXPECT_EQ(scans, FourthDifferences::kBlock + 2 * 4);
}

TEST(Noise, SmallestStepIsTheConvertersResolution) {
  EXPECT_EQ(smallest_step(std::vector<double>{0.5, 0.75, 0.75, 0.625, 1.0}), 0.125);
  EXPECT_EQ(smallest_step(std::vector<double>{0.5, 0.5}), 0.0);
  EXPECT_EQ(smallest_step(std::vector<double>{0.5}), 0.0);
  EXPECT_EQ(smallest_step(std::vector<double>{}), 0.0);
}

TEST(Whiteness, WhiteNoiseHidesNothingHoweverShort) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    EXPECT_FALSE(hides_an_oscillation(white_noise(seed % 2 == 0 ? 68 : 1000, 0.01, seed), 1e-9)) << seed;
  }
}

TEST(Whiteness, SeesAnOscillationThatFourthDifferencesTakeForNoise) {
  for (const double scans_per_cycle : {3.0, 3.7, 4.61, 5.03, 6.53, 8.0}) {
    std::vector<double> values = white_noise(2000, 0.001, 3);
    for (std::size_t k = 0; k < values.size(); ++k)
      values[k] += 0.05 * std::sin(2.0 * pi * static_cast<double>(k) / scans_per_cycle);
    EXPECT_GT(scan_noise(values, 1e-9), 0.0013) << scans_per_cycle;
    EXPECT_TRUE(hides_an_oscillation(values, 1e-9)) << scans_per_cycle;
    for (std::size_t k = 0; k < values.size(); k += 50) values[k] += 2.0;  // Spikes that were left.
    EXPECT_TRUE(hides_an_oscillation(values, 1e-9)) << scans_per_cycle;
  }
}

TEST(Whiteness, DriftLoadingAndSlowWavesHideNothing) {
  for (const double scans_per_cycle : {12.0, 17.5, 200.0}) {
    for (const double sigma : {0.0, 1e-5, 0.001}) {
      std::vector<double> values = white_noise(2000, sigma, 4);
      for (std::size_t k = 0; k < values.size(); ++k) {
        const auto at = static_cast<double>(k);
        values[k] += 0.05 * std::sin(2.0 * pi * at / scans_per_cycle) + 1e-4 * at;
      }
      EXPECT_FALSE(hides_an_oscillation(values, 1e-9)) << scans_per_cycle << " " << sigma;
    }
  }
  EXPECT_FALSE(hides_an_oscillation(std::vector<double>(500, 0.3), 1e-9));
}

TEST(Whiteness, StepsOfTheConverterHideNothing) {
  std::vector<double> values(1000);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = std::floor(0.21 * static_cast<double>(k));
  EXPECT_FALSE(hides_an_oscillation(values, 1.0 / std::sqrt(12.0)));
}

}  // namespace
}  // namespace stickslip::signal
