#include "core/signal/wandering_mean.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/support/allocation_count.hpp"
#include "tests/support/sample_limits.hpp"

namespace stickslip::signal {
namespace {

/// x ← ρ x + √(1 − ρ²) ε: variance 1, long-run variance (1 + ρ)/(1 − ρ).
class Wandering {
 public:
  Wandering(double rho, std::uint64_t seed) : engine_(seed), rho_(rho), value_(normal_(engine_)) {}
  double next() { return value_ = rho_ * value_ + std::sqrt(1.0 - rho_ * rho_) * normal_(engine_); }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
  double rho_;
  double value_;
};

/// Mean square of the mean's error over its standard error.
double mean_square(double rho, int values, int trials) {
  double sum = 0.0;
  for (int trial = 0; trial < trials; ++trial) {
    Wandering series{rho, static_cast<std::uint64_t>(trial) + 1};
    WanderingMean mean;
    for (int i = 0; i < values; ++i) mean.add(series.next());
    const double z = mean.mean() / mean.error_of_mean();
    sum += z * z;
  }
  return sum / trials;
}

// Of independent values the error is that of textbooks, but for the few that look correlated.
TEST(WanderingMean, ErrorOfIndependentValues) {
  WanderingMean mean;
  RunningVariance plain;
  Wandering series{0.0, 1};
  for (int i = 0; i < 400; ++i) {
    const double value = series.next();
    mean.add(value);
    plain.add(value);
  }
  EXPECT_EQ(mean.mean(), plain.mean);
  EXPECT_GE(mean.error_of_mean(), plain.error_of_mean());
  EXPECT_LT(mean.error_of_mean(), 1.2 * plain.error_of_mean());
  constexpr int kTrials = 300;
  EXPECT_LT(mean_square(0.0, 100, kTrials), test::highest_mean_square(kTrials));
  EXPECT_GT(mean_square(0.0, 100, kTrials), 0.6);
}

// As the levels of measured paper from slip to slip, correlated by 0.8: scatter over √n would be three times
// too small, and the mean square of normalised errors nine.
TEST(WanderingMean, ErrorOfCorrelatedValues) {
  constexpr int kTrials = 300;
  for (const int values : {100, 1000, 5000}) {
    const double found = mean_square(0.8, values, kTrials);
    // Of 100 values, eleven are independent: Student's t of so few has a variance of 1.2 and more.
    EXPECT_LT(found, (values > 100 ? 1.2 : 1.8) * test::highest_mean_square(kTrials)) << values;
    // A hundred values cannot exclude that the level wanders more slowly still.
    EXPECT_GT(found, values > 100 ? 0.6 : 0.3) << values;
  }
}

TEST(WanderingMean, CountsIndependentValues) {
  WanderingMean mean;
  Wandering series{0.8, 3};
  for (int i = 0; i < 200'000; ++i) mean.add(series.next());
  EXPECT_EQ(mean.count(), 200'000.0);
  EXPECT_NEAR(mean.variance(), 1.0, 0.05);
  // Blocks of 512 values are longer than what wanders: then they are independent, and one value of 9 is.
  EXPECT_NEAR(mean.error_of_mean() * std::sqrt(200'000.0), 3.0, 0.5);
}

TEST(WanderingMean, OfFewValues) {
  WanderingMean mean;
  mean.add(2.0);
  EXPECT_EQ(mean.mean(), 2.0);
  EXPECT_EQ(mean.error_of_mean(), 0.0);
  mean.add(4.0);
  EXPECT_EQ(mean.error_of_mean(), 1.0);
  const std::uint64_t before = test::allocation_count();
  for (int i = 0; i < 2000; ++i) mean.add(3.0);
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_LT(mean.error_of_mean(), 0.01);
}

}  // namespace
}  // namespace stickslip::signal
