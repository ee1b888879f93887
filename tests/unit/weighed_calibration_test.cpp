// Weights hung on a load cell: what counts, what does not and why, and that the errors are true.

#include "core/daq/weighed_calibration.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "tests/support/sample_limits.hpp"

namespace stickslip::daq {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kStandardGravity_m_per_s2 = 9.80665;
constexpr double kCellGain_N_per_V = 2.0;
constexpr double kCellZero_V = 0.0123;
constexpr double kSpan_V = 20.0;
constexpr unsigned kSeed = 20261122;

WeightReading reading(double mass_kg, double off_V = 0.0) {
  WeightReading result;
  result.mass_kg = mass_kg;
  result.voltage_V = kCellZero_V + mass_kg * kStandardGravity_m_per_s2 / kCellGain_N_per_V + off_V;
  result.standard_error_V = 1e-5;
  result.wander_V = 1e-4;
  return result;
}

/// Nothing, three up, and down again.
std::vector<WeightReading> readings() {
  std::vector<WeightReading> all;
  for (const double mass_kg : {0.0, 0.5, 1.0, 2.0, 1.0, 0.5, 0.0}) all.push_back(reading(mass_kg));
  return all;
}

WeighedCalibration weighed(const std::vector<WeightReading>& all) {
  return weigh(all, kStandardGravity_m_per_s2, kSpan_V);
}

TEST(WeighedCalibration, ExactReadingsGiveGainAndZero) {
  const WeighedCalibration result = weighed(readings());
  ASSERT_TRUE(result.fit.load_cell) << result.fit.reason;
  // Rounding of a handful of sums.
  EXPECT_NEAR(result.fit.load_cell->gain_N_per_V, kCellGain_N_per_V, 1e-13);
  EXPECT_NEAR(result.fit.load_cell->zero_V, kCellZero_V, 1e-13);
  EXPECT_EQ(result.fit.used, 7);
  EXPECT_THAT(result.findings, IsEmpty());
  for (const WeighedPoint& point : result.points) {
    EXPECT_THAT(point.refused, IsEmpty());
    EXPECT_NEAR(point.residual_V, 0.0, 1e-13);
    EXPECT_EQ(point.force_N, point.reading.mass_kg * kStandardGravity_m_per_s2);
  }
}

TEST(WeighedCalibration, StandardErrorsAreThoseOfRepeatedCalibrations) {
  constexpr int kRuns = 300;
  constexpr double kNoise_V = 1e-3;
  std::mt19937_64 random{kSeed};
  std::normal_distribution<double> noise{0.0, kNoise_V};
  double gain_errors = 0.0;
  double gain_variances = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    std::vector<WeightReading> all = readings();
    for (WeightReading& one : all) one.voltage_V += noise(random);
    const WeighedCalibration result = weighed(all);
    ASSERT_TRUE(result.fit.load_cell) << result.fit.reason;
    gain_errors += std::pow(result.fit.load_cell->gain_N_per_V - kCellGain_N_per_V, 2);
    gain_variances += std::pow(*result.fit.gain_standard_error_N_per_V, 2);
  }
  // Each standard error is one of 7 − 2 degrees of freedom: the ratio of two mean squares, of n and of 5 n.
  constexpr double kFreedom = 5.0 * kRuns;
  const double ratio = gain_errors / gain_variances;
  EXPECT_LT(ratio, test::highest_mean_square(kRuns) / test::lowest_mean_square(kFreedom));
  EXPECT_GT(ratio, test::lowest_mean_square(kRuns) / test::highest_mean_square(kFreedom));
}

TEST(WeighedCalibration, BadReadingsAreLeftOutWithTheReason) {
  WeightReading saturated = reading(2.0);
  saturated.saturated = true;
  WeightReading swinging = reading(2.0);
  swinging.wander_V = 0.1;  // Of 9.8 V: 1 %.
  WeightReading forgotten = reading(0.0);
  forgotten.mass_kg = 2.0;              // Typed, not hung.
  WeightReading small = reading(0.02);  // 98 mV of 20 V: 0.5 %.
  WeightReading broken = reading(2.0);
  broken.voltage_V = std::nan("");
  for (const auto& [bad, reason] : {std::pair{saturated, "saturated"},
                                    {swinging, "unstable: moved by 0.1 V"},
                                    {forgotten, "reads like no load"},
                                    {small, "less than 1 %"},
                                    {broken, "no voltage"}}) {
    SCOPED_TRACE(reason);
    std::vector<WeightReading> all = readings();
    all.insert(all.begin() + 3, reading(1.5));
    all.insert(all.begin() + 4, bad);
    const WeighedCalibration result = weighed(all);
    EXPECT_THAT(result.points[4].refused, HasSubstr(reason));
    ASSERT_TRUE(result.fit.load_cell) << result.fit.reason;
    EXPECT_EQ(result.fit.used, 8);
    EXPECT_NEAR(result.fit.load_cell->gain_N_per_V, kCellGain_N_per_V, 1e-13);
  }
}

TEST(WeighedCalibration, ATareThatDoesNotCountIsNoCalibration) {
  for (const bool saturated : {true, false}) {
    std::vector<WeightReading> all = readings();
    all.front().saturated = saturated;
    if (!saturated) all.front().wander_V = 0.1;
    const WeighedCalibration result = weighed(all);
    EXPECT_FALSE(result.fit.load_cell);
    EXPECT_THAT(result.fit.reason, HasSubstr("the tare does not count"));
  }
  std::vector<WeightReading> without = readings();
  without.erase(without.begin());
  EXPECT_THAT(weighed(without).fit.reason, HasSubstr("must be the tare"));
  EXPECT_THAT(weighed({}).fit.reason, HasSubstr("must be the tare"));
}

TEST(WeighedCalibration, NeedsThreeWeightsUpAndThreeReadingsDown) {
  const auto of = [](std::initializer_list<double> masses) {
    std::vector<WeightReading> all;
    for (const double mass_kg : masses) all.push_back(reading(mass_kg));
    return weighed(all);
  };
  EXPECT_THAT(of({0.0, 1.0, 2.0, 1.0, 0.0}).fit.reason, HasSubstr("2 different weights count on the way up"));
  EXPECT_THAT(of({0.0, 1.0, 1.0, 1.0, 0.0}).fit.reason, HasSubstr("1 different weights"));
  EXPECT_THAT(of({0.0, 0.5, 1.0, 2.0}).fit.reason, HasSubstr("0 readings count on the way down"));
  EXPECT_FALSE(of({0.0, 0.5, 1.0, 2.0, 1.0, 0.5}).fit.load_cell);
  EXPECT_TRUE(of({0.0, 0.5, 1.0, 2.0, 1.0, 0.5, 0.0}).fit.load_cell);
  EXPECT_FALSE(of({0.0}).fit.load_cell);
}

TEST(WeighedCalibration, TellsHysteresisAndAWrongWeight) {
  std::vector<WeightReading> lazy = readings();
  for (std::size_t i = 4; i < lazy.size(); ++i) lazy[i].voltage_V += 0.05;
  EXPECT_THAT(base::texts_of(weighed(lazy).findings), testing::Contains(HasSubstr("hysteresis")));
  EXPECT_GT(*weighed(lazy).fit.hysteresis_V, 0.04);
  std::vector<WeightReading> wrong = readings();
  for (WeightReading& one : wrong) {
    if (one.mass_kg == 1.0) one.mass_kg = 1.05;
  }
  EXPECT_THAT(base::texts_of(weighed(wrong).findings), testing::Contains(HasSubstr("off the line")));
}

TEST(ReadingOf, MeanErrorAndWanderOfTheScans) {
  std::mt19937_64 random{kSeed};
  std::normal_distribution<double> noise{1.0, 0.01};
  std::vector<double> voltages(1000);
  for (double& voltage : voltages) voltage = noise(random);
  const WeightReading still = reading_of(0.5, voltages, false);
  EXPECT_EQ(still.mass_kg, 0.5);
  // σ/√n = 3.2e-4; from ten parts it is itself known to 1/√18 = 24 %: a factor of two is three of those and
  // more.
  EXPECT_NEAR(still.voltage_V, 1.0, 4.0 * 3.2e-4);
  EXPECT_GT(*still.standard_error_V, 1.6e-4);
  EXPECT_LT(*still.standard_error_V, 6.4e-4);
  for (std::size_t i = 0; i < voltages.size(); ++i) voltages[i] += 1e-4 * static_cast<double>(i);
  // Parts are 100 scans: the first to the last rise by 900 scans, and the noise moves each by 1e-3.
  EXPECT_NEAR(*reading_of(0.5, voltages, false).wander_V, 0.09, 6e-3);
}

}  // namespace
}  // namespace stickslip::daq
