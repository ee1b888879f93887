#include "core/analysis/characterisation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/Cholesky>

#include "core/analysis/ladder.hpp"
#include "core/analysis/test_analysis.hpp"
#include "tests/support/estimator_limits.hpp"
#include "tests/support/sample_limits.hpp"

namespace stickslip::analysis {
namespace {

constexpr double kInchPerMinute_m_per_s = 0.0254 / 60.0;

TesterEstimate ring_down(double omega, double gamma_over_2omega) {
  TesterEstimate estimate;
  estimate.omega = omega;
  estimate.gamma_over_2omega = gamma_over_2omega;
  estimate.covariance = Eigen::Vector3d{1e-4, 1e-8, 1e-10}.asDiagonal();
  return estimate;
}

TEST(Characterisation, IsTheWeightedMeanOfItsRingDowns) {
  std::vector<TesterEstimate> two{ring_down(125.60, 0.0220), ring_down(125.63, 0.0221)};
  two[1].covariance *= 4.0;  // counts a quarter
  const auto result = pool_ring_downs(two);
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->coupling.omega, 125.606, 1e-9);
  EXPECT_NEAR(result->coupling.gamma_over_2omega, 0.02202, 1e-12);
  EXPECT_EQ(result->freedom, 2);
  // 0.006²/1e-4 + 0.024²/4e-4 and 2e-5²/1e-8 + 8e-5²/4e-8
  EXPECT_NEAR(result->chi_squared, 0.36 + 1.44 + 0.04 + 0.16, 1e-9);
  EXPECT_NEAR(result->coupling.covariance(0, 0), 0.8e-4, 1e-12);  // χ² is not above its freedom
  EXPECT_NEAR(result->probability(), std::exp(-0.5 * result->chi_squared), 1e-12);
}

TEST(Characterisation, IsWidenedWhereRingDownsDisagree) {
  const std::vector<TesterEstimate> two{ring_down(125.0, 0.022), ring_down(126.0, 0.022)};
  const auto result = pool_ring_downs(two);
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->chi_squared, 2.0 * 0.25 / 1e-4, 1e-6);
  EXPECT_NEAR(result->coupling.covariance(0, 0), 0.5e-4 * 2500.0, 1e-9);
  EXPECT_LT(result->probability(), kDisagreement);
  EXPECT_FALSE(pool_ring_downs({}));
}

TEST(Characterisation, NormalisedErrorsOfItsMeanAreChiSquared) {
  // Of four ring-downs χ² has 2 (4 − 1) = 6 degrees of freedom, and over n trials 6 n.
  std::mt19937_64 engine{1};
  std::normal_distribution<double> normal;
  double sum = 0.0;
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<TesterEstimate> four;
    for (int i = 0; i < 4; ++i) {
      const double omega = 125.6 + 1e-2 * normal(engine);
      four.push_back(ring_down(omega, 0.022 + 1e-4 * normal(engine)));
    }
    sum += pool_ring_downs(four)->chi_squared;
  }
  constexpr double kFreedom = 6.0 * kTrials;
  EXPECT_LT(sum / kFreedom, test::highest_mean_square(kFreedom));
  EXPECT_GT(sum / kFreedom, test::lowest_mean_square(kFreedom));
}

class TesterChecked : public testing::Test {
 protected:
  /// A test at 12 in/min of the tester known, with its noise, against what it is told.
  TestAnalysis analysed(const std::optional<estimate::SharedPrior::Coupling>& told, double plan_in_per_min,
                        std::uint64_t seed) const {
    AnalysisSettings settings;
    settings.prior.coupling = told;
    settings.tester.pull_speed_m_per_s = plan_in_per_min * kInchPerMinute_m_per_s;
    TestAnalysis analysis{settings};
    std::mt19937_64 engine{seed};
    std::normal_distribution<double> normal{0.0, test::LimitScene::kSigma};
    base::ScanIndex index = 0;
    for (const double value : scene_.exact()) analysis.add(index++, value + normal(engine), false);
    results_ = analysis.finish();
    return analysis;
  }

  Estimate delta_mu_alone(std::uint64_t seed) const {
    static_cast<void>(analysed({}, 12.0, seed));
    return results_.delta_mu;
  }

  test::LimitScene scene_;
  estimate::SharedPrior::Coupling known_ = *scene_.prior({true, false}).coupling;
  mutable TestResults results_;
};

TEST_F(TesterChecked, PullSpeedIsKnownToHalfAPerCentAndAWrongPlanIsCaught) {
  // Standard error of the speed from the bound: below 0.5 %, so that a plan of 6 in/min is off by 100 σ.
  double squares = 0.0;
  constexpr int kSeeds = 100;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const TestAnalysis right = analysed(known_, 12.0, seed);
    ASSERT_TRUE(right.tester_check());
    const TesterCheck& check = *right.tester_check();
    EXPECT_TRUE(check.findings.empty()) << seed << ": " << check.findings.front().text;
    const double speed = *check.pull_speed.value / kInchPerMinute_m_per_s;
    EXPECT_LT(*check.pull_speed.standard_error / *check.pull_speed.value, 0.005);
    squares +=
        std::pow((speed / 12.0 - 1.0) / (*check.pull_speed.standard_error / *check.pull_speed.value), 2);
  }
  EXPECT_LT(squares / kSeeds, test::highest_mean_square(kSeeds));
  EXPECT_GT(squares / kSeeds, test::lowest_mean_square(kSeeds));
  const TestAnalysis wrong = analysed(known_, 6.0, 1);
  ASSERT_EQ(wrong.tester_check()->findings.size(), 1U);
  EXPECT_NE(wrong.tester_check()->findings.front().text.find("the plan says 6 in/min"), std::string::npos);
}

TEST_F(TesterChecked, AnotherSpringIsAFindingAndIsNotUsed) {
  estimate::SharedPrior::Coupling other = known_;
  other.omega *= 1.01;  // 9 standard errors of one test of ten cycles, whose ω is known to 0.11 %.
  const TestAnalysis analysis = analysed(other, 12.0, 1);
  ASSERT_TRUE(analysis.tester_check());
  EXPECT_FALSE(analysis.tester_check()->used());
  EXPECT_NE(analysis.tester_check()->findings.front().text.find("has changed since the characterisation"),
            std::string::npos);
  // As without it: γ is as uncertain as the test alone leaves it, S − K within four standard errors.
  EXPECT_GT(*results_.gamma_over_2omega.standard_error, 0.05 * 0.022);
  EXPECT_NEAR(*results_.delta_mu.value, 0.05, 4.0 * *results_.delta_mu.standard_error);
}

// A damping that differs from the characterised one by more than chance in 5 % may be a slope of the paper: S
// − K with and without the tester then differ by what is not known.
TEST_F(TesterChecked, ADampingThatAgreesPoorlyIsPartOfTheErrorOfSMinusK) {
  estimate::SharedPrior::Coupling other = known_;
  other.gamma_over_2omega *= 1.12;  // Two standard errors of one test.
  int poor = 0;
  constexpr int kSeeds = 40;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const TestAnalysis analysis = analysed(other, 12.0, seed);
    const Estimate with = results_.delta_mu;
    ASSERT_TRUE(analysis.tester_check() && analysis.tester_check()->used()) << seed;
    const double distance = std::abs(*with.value - *delta_mu_alone(seed).value);
    const bool agrees_poorly = analysis.tester_check()->probability < kSlopeLevel;
    poor += agrees_poorly ? 1 : 0;
    // The rest is the damper's force, gamma v/g [13].
    const double of_damper =
        2.0 * other.gamma_over_2omega * other.omega * 12.0 * kInchPerMinute_m_per_s / 9.80665;
    EXPECT_NEAR(*with.systematic_uncertainty, of_damper + (agrees_poorly ? distance : 0.0), 0.01 * of_damper)
        << seed;
  }
  EXPECT_GE(poor, kSeeds / 5);
}

TEST_F(TesterChecked, KnowingTheTesterCutsTheErrorOfSMinusK) {
  const double alone = scene_.bounds({false, false}).delta_mu;
  (void)analysed(known_, 12.0, 1);
  EXPECT_LT(*results_.delta_mu.standard_error, alone / 4.0);
}

TEST(SpeedFinding, ItsDigitsFollowTheUncertainty) {
  model::Tester tester;
  tester.pull_speed_m_per_s = 0.5 * kInchPerMinute_m_per_s;
  const auto text = [&tester](double measured, double error) {
    return speed_finding(Estimate::of(measured * kInchPerMinute_m_per_s, error * kInchPerMinute_m_per_s),
                         tester)
        .value()
        .text;
  };
  EXPECT_EQ(text(0.45, 0.0021), "the pull speed was 0.4500 +- 0.0021 in/min, the plan says 0.5 in/min");
  EXPECT_EQ(text(0.2, 0.0213), "the pull speed was 0.200 +- 0.021 in/min, the plan says 0.5 in/min");
  // In the unit of the plan.
  tester.pull_speed_m_per_s = 0.1 / 60.0;
  EXPECT_EQ(text(12.0, 0.01), "the pull speed was 304.80 +- 0.25 mm/min, the plan says 100 mm/min");
}

}  // namespace
}  // namespace stickslip::analysis
