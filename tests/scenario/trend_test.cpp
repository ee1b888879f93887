// The control charts on random histories: all seven together, of different distributions, as the figures of
// docs/trend.md say.

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "tests/support/sample_limits.hpp"
#include "tests/support/trend_trials.hpp"

namespace stickslip::trend {
namespace {

constexpr int kHistories = 300;
constexpr std::uint64_t kSeed = 1;
/// The customer's limit, and that of a shift of one standard deviation.
constexpr double kFewestBetweenFalseAlarms = 450.0;
constexpr double kMostUntilTold = 15.0;
/// No chart tells one standard deviation of rare spikes sooner than within 21 tests (docs/evidence.md).
constexpr double kMostUntilSpikesTold = 28.5;

// Times to a rare event are exponential: twice their sum over their mean is χ² with 2n degrees of freedom.
TEST(TrendOfRandomHistories, SevenChartsTogetherRaiseNoMoreFalseAlarmsThanOneIn450Tests) {
  double sum = 0.0;
  for (int i = 0; i < kHistories; ++i)
    sum += static_cast<double>(test::tests_to_false_alarm(kSeed + static_cast<std::uint64_t>(i)));
  const double mean = sum / kHistories;
  EXPECT_GE(mean, kFewestBetweenFalseAlarms * test::lowest_mean_square(2.0 * kHistories));
  // Six of the seven by Siegmund's formula; that of spikes has fewer.
  EXPECT_LE(mean, run_length(0.0) / 6.0 * test::highest_mean_square(2.0 * kHistories));
}

TEST(TrendOfRandomHistories, OneStandardDeviationIsToldWithin15TestsByAFullBaseline) {
  using enum Quantity;
  for (const auto& [quantity, most] : {std::pair{kOmega, kMostUntilTold}, std::pair{kDamping, kMostUntilTold},
                                       std::pair{kZero, kMostUntilTold}, std::pair{kNoise, kMostUntilTold},
                                       std::pair{kSpikes, kMostUntilSpikesTold}}) {
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
    EXPECT_LE(mean, most + sd * test::farthest_mean(told)) << kind_of(quantity).name;
  }
}

}  // namespace
}  // namespace stickslip::trend
