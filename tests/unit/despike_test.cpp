#include "core/signal/despike.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <vector>

namespace stickslip::signal {
namespace {

std::vector<DespikedScan> despiked(std::span<const double> values, double sigma) {
  Despiker despiker;
  std::vector<DespikedScan> scans;
  for (const double value : values) {
    if (const auto scan = despiker.add(value, sigma)) scans.push_back(*scan);
  }
  while (const auto scan = despiker.flush(sigma)) scans.push_back(*scan);
  return scans;
}

std::vector<std::size_t> spikes_in(const std::vector<DespikedScan>& scans) {
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    if (scans[k].spike) found.push_back(k);
  }
  return found;
}

constexpr double kSlope = 0.01;
constexpr double kSigma = 0.001;

std::vector<double> slope(std::size_t count) {
  std::vector<double> values(count);
  for (std::size_t k = 0; k < count; ++k) values[k] = kSlope * static_cast<double>(k);
  return values;
}

TEST(Despike, GivesAsManyScansAsItGetsInTheSameOrder) {
  for (std::size_t length = 0; length <= 7; ++length) {
    const std::vector<double> values = slope(length);
    const std::vector<DespikedScan> scans = despiked(values, kSigma);
    ASSERT_EQ(scans.size(), length);
    for (std::size_t k = 0; k < length; ++k) {
      EXPECT_EQ(scans[k].value, values[k]) << length;
      EXPECT_FALSE(scans[k].spike) << length;
    }
  }
}

TEST(Despike, AnswersTwoScansLate) {
  Despiker despiker;
  const std::vector<double> values = slope(20);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto scan = despiker.add(values[k], kSigma);
    ASSERT_EQ(scan.has_value(), k >= 2);
    if (scan) {
      EXPECT_EQ(scan->value, values[k - 2]);
    }
  }
}

TEST(Despike, EmptyAgainAfterTheFlush) {
  Despiker despiker;
  for (int round = 0; round < 2; ++round) {
    EXPECT_FALSE(despiker.add(1.0, kSigma));
    EXPECT_FALSE(despiker.add(2.0, kSigma));
    EXPECT_EQ(despiker.flush(kSigma)->value, 1.0);
    EXPECT_EQ(despiker.flush(kSigma)->value, 2.0);
    EXPECT_FALSE(despiker.flush(kSigma));
  }
}

TEST(Despike, SpikeOnASlopeIsReplacedToWithinOneScan) {
  // Of ±2, ±1 steps and the spike at an end, the median is one step from the middle.
  for (const double height : {1.0, -1.0}) {
    std::vector<double> values = slope(30);
    values[12] += height;
    const std::vector<DespikedScan> scans = despiked(values, kSigma);
    EXPECT_EQ(spikes_in(scans), std::vector<std::size_t>{12});
    EXPECT_NEAR(scans[12].value, slope(30)[12], kSlope * (1.0 + 1e-12));
  }
}

TEST(Despike, TwoSpikesInARowOnASlope) {
  // The two and three scans of the slope: the median is two steps away, the deviation's median four.
  for (const double height : {1.0, -1.0}) {
    std::vector<double> values = slope(30);
    values[12] += height;
    values[13] += height;
    const std::vector<DespikedScan> scans = despiked(values, kSigma);
    EXPECT_EQ(spikes_in(scans), (std::vector<std::size_t>{12, 13}));
    for (const std::size_t k : {12U, 13U}) {
      EXPECT_NEAR(scans[k].value, slope(30)[k], 2.0 * kSlope * (1.0 + 1e-12));
    }
  }
}

TEST(Despike, SpikeAtTheFirstOrTheLastScan) {
  for (const std::size_t at : {0U, 1U, 18U, 19U}) {
    std::vector<double> values = slope(20);
    values[at] += 1.0;
    const std::vector<DespikedScan> scans = despiked(values, kSigma);
    EXPECT_EQ(spikes_in(scans), std::vector<std::size_t>{at});
    // The window is what there is: its median is at most three steps away.
    EXPECT_NEAR(scans[at].value, slope(20)[at], 3.0 * kSlope * (1.0 + 1e-12));
  }
}

TEST(Despike, SpikeOnAPeakGoesAndThePeakStays) {
  for (int phase = 0; phase < 50; ++phase) {
    std::vector<double> values(70);
    for (std::size_t k = 0; k < values.size(); ++k) {
      values[k] = std::cos(2.0 * std::numbers::pi * (static_cast<double>(k) + 0.02 * phase) / 17.5);
    }
    EXPECT_TRUE(spikes_in(despiked(values, 1.0 / 80.0)).empty()) << phase;
    // Whatever the noise: the first limit alone spares a peak.
    EXPECT_TRUE(spikes_in(despiked(values, 1e-12)).empty()) << phase;
    std::vector<double> spoilt = values;
    spoilt[35] += 1.0;  // near the maximum at 35 − 0.02 phase
    EXPECT_EQ(spikes_in(despiked(spoilt, 1.0 / 80.0)), std::vector<std::size_t>{35}) << phase;
  }
}

TEST(Despike, SlipWithinOneScanIsNoSpike) {
  std::vector<double> values;
  values.reserve(200);
  for (int k = 0; k < 200; ++k) values.push_back(kSlope * (k % 20));
  EXPECT_TRUE(spikes_in(despiked(values, kSigma)).empty());
}

TEST(Despike, NoiseAloneIsHardlyEverASpike) {
  // A large scan lies x − m from the median m, the second largest of its four neighbours (mean 0.30,
  // variance 0.36): beyond 5 σ with 2Q(5.30/√1.36) = 5.6e-6. The other limit can only make it rarer.
  std::mt19937_64 engine{5};
  std::normal_distribution<double> normal{0.3, kSigma};
  std::vector<double> values(1'000'000);
  for (double& value : values) value = normal(engine);
  EXPECT_LE(static_cast<double>(spikes_in(despiked(values, kSigma)).size()), 5.6 + 4.0 * std::sqrt(5.6));
}

}  // namespace
}  // namespace stickslip::signal
