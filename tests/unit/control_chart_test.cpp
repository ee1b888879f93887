#include "core/trend/control_chart.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace stickslip::trend {
namespace {

// Two-sided charts, k = 0.5 [Montgomery 2012, table 9.3, by integral equations]: Siegmund's formula is within
// 1 % of them.
TEST(RunLength, IsThatOfTheTextbook) {
  EXPECT_NEAR(run_length(0.0, 0.5, 4.0), 168.0, 1.68);
  EXPECT_NEAR(run_length(0.0, 0.5, 5.0), 465.0, 4.65);
  EXPECT_NEAR(run_length(1.0, 0.5, 4.0), 8.38, 0.0838);
  EXPECT_NEAR(run_length(1.0, 0.5, 5.0), 10.4, 0.104);
}

TEST(RunLength, OfTheChartsHereIs3500InControlAnd14AfterOneStandardDeviation) {
  EXPECT_NEAR(run_length(0.0), 3500.0, 35.0);
  EXPECT_NEAR(run_length(1.0), 14.3, 0.05);
  EXPECT_EQ(run_length(1.0), run_length(-1.0));
  // Where the drift of an arm vanishes, b² is the limit of the formula.
  EXPECT_NEAR(one_sided_run_length(0.5), one_sided_run_length(0.5 + 2e-5), 0.01);
}

/// Φ⁻¹ by bisection of erf, independent of Boost.
double normal_quantile(double p) {
  double low = -10.0;
  double high = 10.0;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(-middle / std::sqrt(2.0)) < p ? low : high) = middle;
  }
  return low;
}

TEST(ControlChart, AddsNormalScoresOfRanksLessK) {
  ControlChart chart;
  chart.add(3.0);
  EXPECT_EQ(chart.upper(), 0.0);  // The only one is in the middle.
  chart.add(4.0);
  const double second = normal_quantile(1.5 / 2.0) - 0.5;
  EXPECT_NEAR(chart.upper(), second, 1e-12);
  chart.add(5.0);
  EXPECT_NEAR(chart.upper(), second + normal_quantile(2.5 / 3.0) - 0.5, 1e-12);
  EXPECT_EQ(chart.lower(), 0.0);
  chart.add(2.0);
  EXPECT_NEAR(chart.lower(), normal_quantile(3.5 / 4.0) - 0.5, 1e-12);
}

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

TEST(ControlChart, TakesEqualValuesForOneCellOfANormalDistribution) {
  ControlChart chart;
  for (int i = 0; i < 135; ++i) {
    EXPECT_FALSE(chart.add(0.0));
    EXPECT_EQ(chart.upper(), 0.0);
    EXPECT_EQ(chart.lower(), 0.0);
  }
  EXPECT_NEAR(chart.scores(1.0).rising, normal_quantile(135.5 / 136.0) - 0.5, 1e-9);  // The only one.
  for (int i = 0; i < 14; ++i) {
    chart.add(1.0);
    chart.restart_arms();
  }
  // 136 of 150 are 0 with the next 0, and 15 are 1 with the next 1: in a distribution one standard deviation
  // higher, or lower, these cells have other shares.
  // Half a rank at each end is left to the unseen.
  const auto expected = [](double from, double to, double shift) {
    return std::log((normal_cdf(normal_quantile(to / 150.0) - shift) -
                     normal_cdf(normal_quantile(from / 150.0) - shift)) /
                    ((to - from) / 150.0));
  };
  EXPECT_NEAR(chart.scores(0.0).rising, expected(0.5, 136.0, 1.0), 1e-9);
  EXPECT_NEAR(chart.scores(0.0).falling, expected(0.5, 136.0, -1.0), 1e-9);
  EXPECT_NEAR(chart.scores(1.0).rising, expected(135.0, 149.5, 1.0), 1e-9);
  EXPECT_NEAR(chart.scores(1.0).falling, expected(135.0, 149.5, -1.0), 1e-9);
}

// The mean of exp(score) over the baseline is 1 at most, as without ties, where 2k = 1. So the mean run to a
// false alarm of an arm is e^h at least [Lorden, Annals of Mathematical Statistics 42:1897–1908, 1971].
TEST(ControlChart, HasTheFalseAlarmsOfANormalDistributionWithTies) {
  ControlChart chart;
  constexpr std::array kCounts{140, 40, 15, 5};
  for (std::size_t i = 0; i < kCounts.size(); ++i) {
    for (int k = 0; k < kCounts[i]; ++k) {
      chart.add(static_cast<double>(i));
      chart.restart_arms();
    }
  }
  double rising = 0.0;
  double falling = 0.0;
  for (std::size_t i = 0; i < kCounts.size(); ++i) {
    const ControlChart::Scores scores = chart.scores(static_cast<double>(i));
    rising += kCounts[i] / 200.0 * std::exp(scores.rising);
    falling += kCounts[i] / 200.0 * std::exp(scores.falling);
  }
  // Half a rank at the end is left to the unseen. The value itself, one of 201, widens its cell by one rank.
  const double seen = normal_cdf(normal_quantile(1.0 - 0.5 / 201.0) - 1.0);
  EXPECT_NEAR(rising, seen, 0.01);
  EXPECT_NEAR(falling, seen, 0.01);
}

TEST(ControlChart, DoesNotAddUpSpikesThatAreFarApart) {
  ControlChart chart;
  for (int spike = 0; spike < 6; ++spike) {
    for (int k = 0; k < 1000; ++k) EXPECT_FALSE(chart.add(0.0));
    EXPECT_EQ(chart.upper(), 0.0);
    EXPECT_FALSE(chart.add(1.0));
  }
}

TEST(ControlChart, LearnsTheMeanOfACountBeyondAFullBaseline) {
  std::mt19937_64 random{1};
  std::poisson_distribution<int> count{0.105};
  ControlChart chart;
  double sum = 0.0;
  constexpr int kTests = 3000;
  for (int k = 0; k < kTests; ++k) {
    const double value = count(random);
    sum += value;
    chart.add(value);
  }
  // The present excursion of a few dozen values waits.
  EXPECT_NEAR(chart.mean(), sum / kTests, 0.02 * sum / kTests);
}

std::vector<double> random_values(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> normal;
  std::vector<double> values(count);
  for (double& value : values) value = normal(random);
  return values;
}

/// A baseline whose arms are at rest at its end.
ControlChart chart_at_rest(std::int64_t count, std::uint64_t seed) {
  ControlChart chart;
  for (const double value : random_values(static_cast<std::size_t>(count), seed)) chart.add(value);
  while (chart.upper() > 0.0 || chart.lower() > 0.0) chart.add(chart.mean());
  return chart;
}

TEST(ControlChart, TellsDirectionOnsetAndSizeOfAShift) {
  for (const double shift : {10.0, -10.0}) {
    ControlChart chart = chart_at_rest(kFullBaseline, 1);
    const std::int64_t before = chart.count();
    std::optional<ChartAlarm> alarm;
    for (int i = 0; i < 10 && !alarm; ++i) alarm = chart.add(shift);
    ASSERT_TRUE(alarm);
    EXPECT_EQ(alarm->rises, shift > 0.0);
    EXPECT_EQ(alarm->onset, before);
    EXPECT_EQ(alarm->told, chart.count() - 1);
    // The mean before has a standard error of 1/√200; five of them.
    EXPECT_NEAR(alarm->shift, shift, 5.0 / std::sqrt(static_cast<double>(kFullBaseline)));
    EXPECT_EQ(chart.upper(), 0.0);
    EXPECT_EQ(chart.lower(), 0.0);
    EXPECT_NEAR(alarm->standard_deviation, 1.0, 5.0 / std::sqrt(2.0 * kFullBaseline));
  }
}

TEST(ControlChart, KeepsAnExcursionOutOfAFullBaselineUntilItIsOver) {
  ControlChart full = chart_at_rest(kFullBaseline, 2);
  const double mean = full.mean();
  full.add(100.0);
  full.add(100.0);
  EXPECT_GT(full.upper(), 0.0);
  EXPECT_EQ(full.mean(), mean);
  while (full.upper() > 0.0 || full.lower() > 0.0) full.add(mean);
  EXPECT_GT(full.mean(), mean + 0.5);  // Twice 100 among some 200.

  ControlChart young = chart_at_rest(kFullBaseline / 2, 2);
  const double young_mean = young.mean();
  young.add(100.0);
  EXPECT_GT(young.upper(), 0.0);
  EXPECT_GT(young.mean(), young_mean + 0.5);
}

TEST(ControlChart, MarksValuesBeyondThreeStandardDeviationsAndRaisesNoAlarmForOne) {
  ControlChart chart;
  for (const double value : random_values(static_cast<std::size_t>(kFewestForLimits) - 1, 3))
    chart.add(value);
  EXPECT_FALSE(chart.add(1e3));
  EXPECT_FALSE(chart.is_outside());  // Too few before it for limits.
  chart = chart_at_rest(100, 3);
  const double limit = 3.0 * chart.standard_deviation();
  EXPECT_FALSE(chart.add(chart.mean() + 1.01 * limit));
  EXPECT_TRUE(chart.is_outside());
  chart = chart_at_rest(100, 3);
  chart.add(chart.mean() - 0.99 * limit);
  EXPECT_FALSE(chart.is_outside());
}

// Ranks do not know the unit, nor any rising transformation: so the rate of false alarms is that of all
// continuous distributions. A falling one exchanges the arms.
RC_GTEST_PROP(ControlChartProperty, DependsOnTheOrderOfTheValuesAlone, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const double shift = *rc::gen::element(0.0, 1.0, 3.0);
  const auto values = random_values(300, seed);
  ControlChart plain;
  ControlChart rising;
  ControlChart falling;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = values[i] + (i < 220 ? 0.0 : shift);
    const auto alarm = plain.add(value);
    const auto of_rising = rising.add(std::exp(value));
    const auto of_falling = falling.add(-value);
    RC_ASSERT(alarm.has_value() == of_rising.has_value());
    RC_ASSERT(alarm.has_value() == of_falling.has_value());
    if (alarm) {
      RC_ASSERT(alarm->onset == of_rising->onset);
      RC_ASSERT(alarm->rises == of_rising->rises);
      RC_ASSERT(alarm->rises != of_falling->rises);
    }
    RC_ASSERT(plain.upper() == rising.upper());
    RC_ASSERT(std::abs(plain.upper() - falling.lower()) < 1e-9);
  }
}

TEST(ControlChart, HasABaselineOfLimitedSize) {
  std::mt19937_64 random{1};
  std::normal_distribution<double> normal;
  ControlChart chart;
  for (std::int64_t k = 0; k < kLargestBaseline + 500; ++k) chart.add(normal(random));
  const double mean = chart.mean();
  // Values beyond the limit, far away though they are, do not move what they are compared with.
  for (int k = 0; k < 500; ++k) {
    chart.add(10.0);
    chart.restart_arms();
  }
  EXPECT_EQ(chart.mean(), mean);
  EXPECT_NEAR(mean, 0.0, 4.0 / std::sqrt(static_cast<double>(kLargestBaseline)));
}

}  // namespace
}  // namespace stickslip::trend
