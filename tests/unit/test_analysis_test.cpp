#include "core/friction/test_analysis.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

#include "tests/support/allocation_count.hpp"
#include "tests/support/live_trials.hpp"

namespace stickslip::friction {
namespace {

TEST(TestAnalysis, AddsAScanWithoutAllocatingUntilABlockIsFull) {
  std::mt19937_64 engine{4};
  std::normal_distribution<double> normal{0.3, 0.001};
  TestAnalysis analysis{AnalysisSettings{}};
  analysis.add(0, 0.3, false);  // takes the first block of each column
  const std::uint64_t before = test::allocation_count();
  constexpr auto kBlock = static_cast<base::ScanIndex>(base::LongColumn<double>::kBlock);
  for (base::ScanIndex scan = 1; scan < kBlock; ++scan) analysis.add(scan, normal(engine), false);
  EXPECT_EQ(test::allocation_count(), before);
  analysis.add(kBlock, 0.3, false);
  EXPECT_GT(test::allocation_count(), before);  // else the test shows nothing
}

// ω, γ, regime and periods come from the fit of the whole test whatever the estimator; S and K do not.
TEST(TestAnalysis, EstimatorChangesWhereSAndKComeFromAndNothingElse) {
  const test::LiveScene scene;
  const auto analysed = [&](EstimatorTier tier) {
    AnalysisSettings settings;
    settings.estimator = tier;
    TestAnalysis analysis{settings};
    test::LiveTrial trial{scene};
    for (base::ScanIndex scan = 0; scan < trial.scan_count(); ++scan) analysis.add(scan, trial.next(), false);
    TestResults results = analysis.finish();
    EXPECT_EQ(analysis.live().phase, Phase::kEnd);
    EXPECT_EQ(analysis.live().regime, Regime::kStickSlip);
    return results;
  };
  const TestResults fit = analysed(EstimatorTier::kFit);
  for (const EstimatorTier tier : {EstimatorTier::kPeak, EstimatorTier::kInterpolated}) {
    const TestResults other = analysed(tier);
    EXPECT_EQ(other.regime, fit.regime);
    EXPECT_EQ(other.omega, fit.omega);
    EXPECT_EQ(other.gamma_over_2omega, fit.gamma_over_2omega);
    EXPECT_EQ(other.period_median, fit.period_median);
    EXPECT_EQ(other.static_coefficient, fit.static_coefficient);
    ASSERT_TRUE(other.delta_mu.value) << other.delta_mu.reason;
    EXPECT_NE(other.delta_mu, fit.delta_mu);
    EXPECT_NEAR(*other.mu_s.value - *other.mu_k.value, *other.delta_mu.value, 1e-12);
    // Peaks stand out by the amplitude, up to √(1 + Q²) = 1.65 of S − K; turning points know better.
    const double over = *other.delta_mu.value / (scene.S - scene.K);
    EXPECT_GT(over, tier == EstimatorTier::kPeak ? 1.4 : 0.9);
    EXPECT_LT(over, tier == EstimatorTier::kPeak ? 1.65 : 1.1);
  }
}

}  // namespace
}  // namespace stickslip::friction
