// The control charts on random histories: all seven together, of different distributions, as the figures of
// docs/trend.md say.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/sample_limits.hpp"
#include "tests/support/trend_trials.hpp"

namespace stickslip::trend {
namespace {

constexpr int kHistories = 300;
constexpr std::uint64_t kSeed = 1;
/// The customer's limit, and that of a shift of one standard deviation.
constexpr double kFewestBetweenFalseAlarms = 450.0;
constexpr double kMostUntilTold = 15.0;

// Times to a rare event are exponential: twice their sum over their mean is χ² with 2n degrees of freedom.
TEST(TrendOfRandomHistories, SevenChartsTogetherRaiseNoMoreFalseAlarmsThanOneIn450Tests) {
  double sum = 0.0;
  for (int i = 0; i < kHistories; ++i)
    sum += static_cast<double>(test::tests_to_false_alarm(kSeed + static_cast<std::uint64_t>(i)));
  const double mean = sum / kHistories;
  EXPECT_GE(mean, kFewestBetweenFalseAlarms * test::lowest_mean_square(2.0 * kHistories));
  // Six of the seven by Siegmund's formula, and a chart of spikes that hardly ever alarms.
  EXPECT_LE(mean, run_length(0.0) / 6.0 * test::highest_mean_square(2.0 * kHistories));
}

TEST(TrendOfRandomHistories, OneStandardDeviationIsToldWithin15TestsByAFullBaseline) {
  for (const Quantity quantity : {Quantity::kOmega, Quantity::kZero, Quantity::kNoise}) {
    double sum = 0.0;
    double squares = 0.0;
    int told = 0;
    for (int i = 0; i < kHistories; ++i) {
      const auto delay =
          test::tests_to_alarm(kSeed + static_cast<std::uint64_t>(i), kFullBaseline, {quantity, 1.0});
      if (!delay) continue;
      ++told;
      sum += static_cast<double>(*delay);
      squares += static_cast<double>(*delay * *delay);
    }
    const double mean = sum / told;
    const double sd = std::sqrt(squares / told - mean * mean);
    EXPECT_LE(mean, kMostUntilTold + sd * test::farthest_mean(told)) << kind_of(quantity).name;
  }
}

}  // namespace
}  // namespace stickslip::trend
