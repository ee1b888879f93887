#include "core/law/friction_law.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/law/line.hpp"
#include "core/law/measured_tests.hpp"
#include "core/law/next_pull.hpp"

namespace stickslip::law {
namespace {

constexpr double kInPerMin = 0.0254 / 60.0;

/// S = 0.38 + β log₁₀(t/1 s), K = 0.30 + μ′ v, t = 6e-5 m/v, with this error and offsets of it in turn.
LawTest test_at(double in_per_min, double beta, double mu_slope, double offset = 0.0, double error = 1e-4) {
  LawTest test;
  test.pull_speed_m_per_s = in_per_min * kInPerMin;
  test.stick_time_s = 6e-5 / test.pull_speed_m_per_s;
  test.S = Value{0.38 + beta * std::log10(*test.stick_time_s) + offset * error, error, 0.0};
  test.K = Value{0.30 + mu_slope * test.pull_speed_m_per_s - offset * error, error, 0.0};
  return test;
}

std::vector<LawTest> tests_at(const std::vector<double>& speeds, double beta, double mu_slope) {
  std::vector<LawTest> tests;
  for (const double speed : speeds) {
    for (const double offset : {-1.0, 0.3, 0.7}) tests.push_back(test_at(speed, beta, mu_slope, offset));
  }
  return tests;
}

const std::vector<double> kFourSpeeds{1.5, 3.0, 6.0, 12.0};

TEST(LawLine, BetweenVarianceMakesTheResidualsWhatTheirFreedomSays) {
  const std::vector<Point> points{{0, 0.1, 0.1}, {1, 0.9, 0.2}, {2, 2.6, 0.1}, {3, 2.5, 0.3}};
  const std::optional<Line> line = fit_line(points, true);
  ASSERT_TRUE(line && line->slope);
  double chi_squared = 0.0;
  for (const Point& point : points) {
    chi_squared += std::pow(point.y - line->predicted(point.x).value, 2) /
                   (point.error * point.error + line->between_variance);
  }
  EXPECT_GT(line->between_variance, 0.0);
  EXPECT_NEAR(chi_squared, 2.0, 1e-9);
  // Twice the error is the half width by Student's t with two degrees of freedom.
  EXPECT_NEAR(2.0 * line->slope->error, 4.302653 * std::sqrt(line->covariance(1, 1)), 1e-6);
}

TEST(LawLine, ScattersNoMoreThanItsErrorsSay) {
  const std::vector<Point> points{{0, 0.01, 0.1}, {1, 0.99, 0.1}, {2, 2.01, 0.1}};
  EXPECT_EQ(fit_line(points, true)->between_variance, 0.0);
}

TEST(LawLine, SystematicPartsMoveAllPointsTogether) {
  std::vector<Point> points{{0, 1, 0.1, 0.5}, {1, 2, 0.1, 0.5}, {2, 3, 0.1, 0.5}};
  EXPECT_NEAR(fit_line(points, true)->level.systematic, 0.5, 1e-12);
  EXPECT_NEAR(fit_line(points, true)->slope->systematic, 0.0, 1e-12);
  for (Point& point : points) point.systematic = 0.2 * point.x;
  EXPECT_NEAR(fit_line(points, true)->slope->systematic, 0.2, 1e-12);
}

TEST(LawLine, OnePlaceHasNoSlope) {
  const std::vector<Point> points{{1, 0.1, 0.1}, {1, 0.9, 0.2}, {1, 2.6, 0.1}};
  EXPECT_TRUE(fit_line(points, false));
  EXPECT_FALSE(fit_line(points, true));
  EXPECT_FALSE(fit_line(std::span{points}.first(1), false));
}

/// Far from 0 the terms of a variance about 0 cancel below it.
TEST(LawLine, VarianceIsNeverBelowZero) {
  const std::vector<Point> points{{1e6, 0.1, 1e-4}, {1e6 + 0.01, 0.2, 1e-4}, {1e6 + 0.02, 0.3, 1e-4}};
  const std::optional<Line> line = fit_line(points, true);
  ASSERT_TRUE(line);
  for (const Point& point : points) {
    EXPECT_GT(line->predicted(point.x).variance, 0.0);
    EXPECT_NEAR(line->predicted(point.x).value, point.y, 1e-6);
    EXPECT_TRUE(std::isfinite(line->log_density(point)));
  }
  const double at_ends = 1e-8 * (1.0 / 3.0 + 1.0 / 2.0);
  EXPECT_NEAR(line->predicted(1e6).variance, at_ends, 1e-3 * at_ends);
}

TEST(FrictionLaw, EachOfTheFourIsNamed) {
  constexpr double kBeta = 0.02;
  constexpr double kSlope = 2.0;
  for (const Law law : kLaws) {
    const double beta = has_ageing(law) ? kBeta : 0.0;
    const double slope = has_rate(law) ? kSlope : 0.0;
    const FrictionLaw found = find_law(tests_at(kFourSpeeds, beta, slope));
    EXPECT_TRUE(found.told) << name(law) << ": " << found.ageing.reason << found.rate.reason;
    EXPECT_EQ(name(found.law), name(law));
    EXPECT_NEAR(found.ageing.line->slope->value, beta, 3.0 * found.ageing.line->slope->error);
    EXPECT_NEAR(found.rate.line->slope->value, slope, 3.0 * found.rate.line->slope->error);
    EXPECT_FALSE(next_pull(found, tests_at(kFourSpeeds, beta, slope), {1e-4, 1e-2}, {}));
  }
}

TEST(FrictionLaw, OneSpeedTellsNothingAndNamesASecondFarAway) {
  const std::vector<LawTest> tests = tests_at({6.0}, 0.02, 0.0);
  const FrictionLaw found = find_law(tests);
  EXPECT_FALSE(found.told);
  ASSERT_FALSE(found.scores);  // Three tests.
  const std::vector<LawTest> more = tests_at({6.0, 6.0}, 0.02, 0.0);
  const FrictionLaw again = find_law(more);
  EXPECT_FALSE(again.told);
  EXPECT_EQ(again.ageing.reason, "all tests for S on the stick time are at one speed");
  for (const auto& [own, own_tests] : {std::pair{&found, &tests}, {&again, &more}}) {
    const std::optional<NextPull> next = next_pull(*own, *own_tests, usual_range(*own_tests), {});
    ASSERT_TRUE(next);
    const double apart = next->pull_speed_m_per_s / (6.0 * kInPerMin);
    EXPECT_GE(std::max(apart, 1.0 / apart), 3.0 * (1.0 - 1e-12));
  }
}

TEST(FrictionLaw, TheSameSpeedInOtherUnitsIsNoSecondSpeed) {
  std::vector<LawTest> tests = tests_at({6.0, 6.0}, 0.02, 1.0);
  for (std::size_t i = 1; i < tests.size(); i += 2)
    tests[i].pull_speed_m_per_s = 152.4e-3 / 60.0 * (1.0 + 4.0 * std::numeric_limits<double>::epsilon());
  ASSERT_NE(tests[0].pull_speed_m_per_s, tests[1].pull_speed_m_per_s);
  const FrictionLaw found = find_law(tests);
  EXPECT_FALSE(found.ageing.line);
  EXPECT_FALSE(found.rate.line);
  EXPECT_EQ(found.rate.reason, "all tests for K on the speed are at one speed");
  ASSERT_TRUE(found.scores);
  for (const LawScore& score : *found.scores) EXPECT_TRUE(std::isfinite(score.score));
}

TEST(FrictionLaw, AChainOfNearSpeedsIsNotOneSpeed) {
  std::vector<LawTest> tests;
  for (const double speed : {6.09, 6.00, 6.13, 6.05}) tests.push_back(test_at(speed, 0.0, 0.0));
  const FrictionLaw found = find_law(tests);
  const std::vector<Point>& K = found.rate.points;
  EXPECT_EQ(K[1].x, K[3].x);  // 6.00 and 6.05
  EXPECT_EQ(K[0].x, K[2].x);  // 6.09 and 6.13
  EXPECT_NEAR(K[1].x, 6.025 * kInPerMin, 1e-12);
  EXPECT_NEAR(K[0].x, 6.11 * kInPerMin, 1e-12);
  EXPECT_EQ(found.ageing.points[1].x, found.ageing.points[3].x);
  EXPECT_TRUE(found.rate.line);
}

TEST(FrictionLaw, ThreeTestsAreTooFew) {
  const std::vector<LawTest> tests{test_at(1.5, 0.02, 0), test_at(3, 0.02, 0), test_at(12, 0.02, 0)};
  const FrictionLaw found = find_law(tests);
  EXPECT_FALSE(found.told);
  EXPECT_EQ(found.ageing.reason, "3 values for S on the stick time, at least 4 are needed");
}

/// A test whose S is higher by chance also takes longer to reach it.
TEST(FrictionLaw, ChanceAtOneSpeedIsNoAgeing) {
  std::vector<LawTest> tests = tests_at({6.0, 6.0, 6.0}, 0.0, 0.0);
  for (LawTest& test : tests) test.stick_time_s = *test.stick_time_s * (1.0 + 20.0 * (test.S->value - 0.38));
  const FrictionLaw found = find_law(tests);
  EXPECT_EQ(found.law, Law::kConstant);
  EXPECT_FALSE(found.ageing.line);
}

TEST(FrictionLaw, WhatTheSystematicPartsCouldMakeIsNotNamed) {
  std::vector<LawTest> tests = tests_at(kFourSpeeds, 0.006, 0.0);
  EXPECT_TRUE(find_law(tests).told);
  for (LawTest& test : tests) test.S->systematic = -0.008 * std::log10(*test.stick_time_s);
  const FrictionLaw found = find_law(tests);
  EXPECT_FALSE(found.told);
  EXPECT_EQ(found.law, Law::kAgeing);
  EXPECT_EQ(found.ageing.reason,
            "S on the stick time is seen, but its systematic part may have made it: more pulls do not help");
  EXPECT_FALSE(next_pull(found, tests, usual_range(tests), {}));
}

TEST(FrictionLaw, WhatTheSystematicPartsCouldHideIsNotRuledOut) {
  std::vector<LawTest> tests = tests_at(kFourSpeeds, 0.0, 0.0);
  ASSERT_EQ(find_law(tests).ageing.verdict, Verdict::kNo);
  ASSERT_NEAR(find_law(tests).ageing.slope_that_matters, 0.008, 1e-4);
  for (LawTest& test : tests) test.S->systematic = -0.016 * std::log10(*test.stick_time_s);
  const FrictionLaw found = find_law(tests);
  EXPECT_FALSE(found.told);
  EXPECT_EQ(found.law, Law::kConstant);
  EXPECT_EQ(found.ageing.verdict, Verdict::kCannotTell);
  EXPECT_TRUE(found.ageing.systematic_vetoes);
  EXPECT_NE(found.ageing.reason.find("times what matters (a tenth of S - K over a decade of speed), by its "
                                     "systematic part: more pulls do not help"),
            std::string::npos)
      << found.ageing.reason;
  EXPECT_FALSE(next_pull(found, tests, usual_range(tests), {}));
}

TEST(FrictionLaw, WithoutKItIsNotKnownWhatMatters) {
  std::vector<LawTest> tests = tests_at(kFourSpeeds, 0.0, 0.0);
  for (LawTest& test : tests) test.K.reset();
  const FrictionLaw found = find_law(tests);
  EXPECT_FALSE(found.told);
  EXPECT_EQ(found.ageing.reason,
            "S on the stick time is not seen, but no test has K, so what matters is not known");
  EXPECT_FALSE(next_pull(found, tests, usual_range(tests), {}));
}

/// Of two speeds close together with tests that scatter, neither law can be ruled out.
TEST(FrictionLaw, APoorDesignIsNotToldToBeConstant) {
  std::vector<LawTest> tests;
  for (const double speed : {6.0, 7.0}) {
    for (const double offset : {-1.0, 0.0, 1.0}) tests.push_back(test_at(speed, 0.0, 0.0, offset, 2e-3));
  }
  const FrictionLaw found = find_law(tests);
  EXPECT_FALSE(found.told);
  const std::optional<NextPull> next = next_pull(found, tests, usual_range(tests), {});
  ASSERT_TRUE(next);
  EXPECT_TRUE(next->tells_ageing);
  EXPECT_GT(next->separation, 0.0);
}

TEST(NextPull, IsSlowEnoughToStick) {
  const std::vector<LawTest> tests = tests_at({3.0, 3.0}, 0.0, 0.0);
  const double threshold = 6.0 * kInPerMin;
  const std::optional<NextPull> next =
      next_pull(find_law(tests), tests, {2.9 * kInPerMin, 50.0 * kInPerMin}, threshold);
  ASSERT_TRUE(next);
  EXPECT_LE(next->pull_speed_m_per_s, 0.8 * threshold * (1.0 + 1e-12));
  // Where no pull sticks, K is asked.
  const std::optional<NextPull> fast =
      next_pull(find_law(tests), tests, {20.0 * kInPerMin, 50.0 * kInPerMin}, threshold);
  ASSERT_TRUE(fast);
  EXPECT_FALSE(fast->tells_ageing);
  EXPECT_NEAR(fast->pull_speed_m_per_s, 50.0 * kInPerMin, 1e-9);
}

TEST(NextPull, TestsWithoutSticksAskForK) {
  std::vector<LawTest> tests = tests_at({6.0, 6.0}, 0.0, 0.0);
  for (LawTest& test : tests) test.S.reset();
  const std::optional<NextPull> next = next_pull(find_law(tests), tests, usual_range(tests), {});
  ASSERT_TRUE(next);
  EXPECT_FALSE(next->tells_ageing);
  EXPECT_NEAR(next->pull_speed_m_per_s, 18.0 * kInPerMin, 1e-9);
}

analysis::MeasuredTest measured_at(double in_per_min) {
  analysis::MeasuredTest test;
  analysis::for_each_result(test.results, [](const analysis::ResultName&, analysis::Estimate& estimate) {
    estimate = analysis::Estimate::none("not in this test");
  });
  test.pull_speed_m_per_s = in_per_min * kInPerMin;
  test.results.regime = model::Regime::kStickSlip;
  test.results.rung = analysis::Rung::kLawWithSlope;
  test.results.mu_s = {0.35, 1e-3, 2e-3, {}};
  test.results.mu_k = {0.30, 1e-3, {}, {}};
  test.stick_time_s = 0.01;
  return test;
}

TEST(LawTests, ASoundTestCountsWithItsErrors) {
  const LawTests found = tests_for_law(std::vector{measured_at(6)});
  ASSERT_EQ(found.tests.size(), 1U);
  EXPECT_TRUE(found.left_out.empty());
  EXPECT_EQ(found.tests[0].S->error, 1e-3);
  EXPECT_EQ(found.tests[0].S->systematic, 2e-3);
}

TEST(LawTests, FaultsRepeatedScansRampsAndUnknownSpeedsCountForNothing) {
  std::vector<analysis::MeasuredTest> tests(4, measured_at(6));
  base::add(tests[0].results.findings, base::make_finding(base::FindingCode::kClipped, "clipped"));
  base::add(tests[1].results.findings, base::make_finding(base::FindingCode::kRepeatedScans, "repeated"));
  tests[2].results.Q = analysis::Estimate::none(std::string{analysis::kSpeedChanges});
  tests[3].pull_speed_m_per_s.reset();
  const LawTests found = tests_for_law(tests);
  EXPECT_TRUE(found.tests.empty());
  ASSERT_EQ(found.left_out.size(), 4U);
  for (const LeftOut& out : found.left_out) EXPECT_EQ(out.what, "S and K");
  EXPECT_EQ(found.left_out[0].reason, "clipped");
  EXPECT_EQ(found.left_out[1].reason, "repeated");
}

TEST(LawTests, ARingDownTellsKAlone) {
  analysis::MeasuredTest test = measured_at(12);
  test.results.regime = model::Regime::kRingDown;
  test.stick_time_s.reset();
  const LawTests found = tests_for_law(std::vector{test});
  ASSERT_EQ(found.tests.size(), 1U);
  EXPECT_FALSE(found.tests[0].S);
  EXPECT_TRUE(found.tests[0].K);
  ASSERT_EQ(found.left_out.size(), 1U);
  EXPECT_EQ(found.left_out[0].what, "S");
}

TEST(LawTests, SteadySlidingTellsKByItsMeanWithTheLargestErrorOfTheOthers) {
  std::vector<analysis::MeasuredTest> tests(2, measured_at(12));
  tests[1].results.regime = model::Regime::kSteadySliding;
  tests[1].results.mu_s = tests[1].results.mu_k = analysis::Estimate::none("no slip");
  tests[1].results.kinetic_coefficient = analysis::Estimate::of(0.31);
  tests[1].stick_time_s.reset();
  const LawTests found = tests_for_law(tests);
  ASSERT_EQ(found.tests.size(), 2U);
  EXPECT_EQ(found.tests[1].K->value, 0.31);
  EXPECT_EQ(found.tests[1].K->error, 1e-3);
}

TEST(LawTests, TheCorrectionOfTurningPointsIsAnErrorOfEachTest) {
  analysis::MeasuredTest test = measured_at(6);
  test.results.rung = analysis::Rung::kTurningPoints;
  test.results.mu_s.standard_error.reset();
  const LawTests found = tests_for_law(std::vector{test});
  EXPECT_EQ(found.tests[0].S->error, 2e-3);
  EXPECT_EQ(found.tests[0].S->systematic, 0.0);
}

/// One sheet: slips at 3 in/min, and one slip after each of four holds.
TEST(FrictionLaw, HoldsAtOneSpeedTellAgeing) {
  std::vector<LawTest> tests{test_at(3.0, 0.02, 0.0)};
  for (const double hold_s : {1.0, 3.0, 10.0, 30.0}) {
    LawTest test;
    test.pull_speed_m_per_s = 3.0 * kInPerMin;
    test.stick_time_s = hold_s;
    test.held = true;
    test.S = Value{0.38 + 0.02 * std::log10(hold_s), 1e-3, 0.0};
    tests.push_back(test);
  }
  const FrictionLaw found = find_law(tests);
  EXPECT_EQ(found.ageing.verdict, Verdict::kYes);
  EXPECT_NEAR(found.ageing.line->slope->value, 0.02, 1e-9);
  EXPECT_EQ(found.law, Law::kAgeing);
  EXPECT_FALSE(found.told);  // One speed tells nothing about K.
  // A hold says nothing about how long a pull at another speed would let the sled rest.
  const auto next = next_pull(found, tests, {0.1 * kInPerMin, 30.0 * kInPerMin}, std::nullopt);
  ASSERT_TRUE(next);
  EXPECT_FALSE(next->tells_ageing);
}

TEST(FrictionLaw, AsksForALongerHoldWhereHoldsAreMade) {
  std::vector<LawTest> tests{test_at(3.0, 0.0, 0.0)};
  for (const double offset : {-1.0, 1.0, -1.0, 1.0}) {
    LawTest test;
    test.pull_speed_m_per_s = 3.0 * kInPerMin;
    test.stick_time_s = 1.0 + 0.1 * offset;
    test.held = true;
    test.S = Value{0.36 + 0.02 * offset, 0.02, 0.0};
    tests.push_back(test);
  }
  const auto next = next_pull(find_law(tests), tests, {1.0 * kInPerMin, 9.0 * kInPerMin}, std::nullopt);
  ASSERT_TRUE(next);
  EXPECT_TRUE(next->tells_ageing);
  EXPECT_EQ(next->hold_s, kLongestHold_s);
  EXPECT_NEAR(next->pull_speed_m_per_s, 3.0 * kInPerMin, 1e-12);
  // A hold can be made where no pull of the range sticks.
  const auto only_hold =
      next_pull(find_law(tests), tests, {20.0 * kInPerMin, 50.0 * kInPerMin}, 6.0 * kInPerMin);
  ASSERT_TRUE(only_hold);
  EXPECT_TRUE(only_hold->tells_ageing);
  EXPECT_EQ(only_hold->hold_s, kLongestHold_s);
}

/// Four slow pulls, each on its sheet, and a sheet with slips at 1 in/min and after four holds, of a
/// rate-and-state contact. The S of a slip after a hold is as it is measured: on the K of usual slips, which
/// are slower. \param level  by which the sheet with holds is higher.
std::vector<LawTest> rate_and_state_tests(double a, double b, double level = 0.0) {
  constexpr double kK = 0.30;
  constexpr double kError = 5e-4;
  const auto S = [&](double v, double rest_s) {
    return 0.45 + a * std::log(v / kInPerMin) + b * std::log(rest_s);
  };
  std::vector<LawTest> tests;
  double sign = 1.0;
  for (const double speed : {0.2, 0.4, 0.75, 1.5, 1.0}) {
    LawTest test = test_at(speed, 0.0, 0.0, 0.0, kError);
    test.S->value = S(test.pull_speed_m_per_s, *test.stick_time_s) + 0.5 * (sign = -sign) * kError;
    test.K->value = kK;
    test.sheet = tests.size();
    tests.push_back(test);
  }
  tests.back().S->value += level;
  tests.back().K->value += level;
  const double usual = tests.back().S->value - tests.back().K->value;
  for (const double hold_s : {1.0, 3.0, 10.0, 30.0}) {
    LawTest test;
    test.pull_speed_m_per_s = kInPerMin;
    test.stick_time_s = hold_s;
    test.held = true;
    test.sheet = 4;
    const double own = S(test.pull_speed_m_per_s, hold_s);
    double measured = own;
    for (int i = 0; i < 50; ++i) measured = own + (b - a) * std::log((measured - kK) / usual);
    test.S = Value{measured + level + 0.5 * (sign = -sign) * kError, kError, 0.0};
    tests.push_back(test);
  }
  return tests;
}

/// Without a direct effect, where K does not depend on how fast the sled slips.
std::vector<LawTest> ageing_tests(double level) {
  std::vector<LawTest> tests = rate_and_state_tests(0.0, 0.0, level);
  for (LawTest& test : tests) test.S->value += 0.02 * std::log10(*test.stick_time_s);
  return tests;
}

TEST(RateAndStates, PullsAndHoldsTellBothEffects) {
  const std::vector<LawTest> tests = rate_and_state_tests(0.010, 0.025);
  const FrictionLaw found = find_law(tests);
  ASSERT_TRUE(found.is_rate_and_state());
  EXPECT_TRUE(found.told);
  EXPECT_EQ(name(found), "rate-and-state");
  EXPECT_TRUE(found.ageing.reason.empty());
  const RateAndState& law = *found.rate_and_state;
  EXPECT_NEAR(law.a.value, 0.010, 2.0 * law.a.error);
  EXPECT_NEAR(law.b.value, 0.025, 2.0 * law.b.error);
  EXPECT_LT(law.a.error, 0.001);
  EXPECT_LT(law.b.error, 0.001);
  for (std::size_t i = 0; i < tests.size(); ++i) EXPECT_NEAR(*law.S[i], tests[i].S->value, 1e-3) << i;
  EXPECT_FALSE(next_pull(found, tests, {kInPerMin, 9.0 * kInPerMin}, std::nullopt));
}

/// The other sheets say nothing about the level of the one with holds.
TEST(RateAndStates, TheLevelOfTheSheetWithHoldsDoesNotMatter) {
  const FrictionLaw found = find_law(rate_and_state_tests(0.010, 0.025));
  const FrictionLaw higher = find_law(rate_and_state_tests(0.010, 0.025, 0.02));
  ASSERT_TRUE(higher.is_rate_and_state());
  EXPECT_NEAR(higher.rate_and_state->a.value, found.rate_and_state->a.value, 1e-9);
  EXPECT_NEAR(higher.rate_and_state->b.value, found.rate_and_state->b.value, 1e-9);
  for (const double level : {-0.02, -0.005, 0.0, 0.005, 0.02}) {
    const FrictionLaw ageing = find_law(ageing_tests(level));
    ASSERT_TRUE(ageing.rate_and_state);
    EXPECT_TRUE(ageing.rate_and_state->may_have_none) << level;
    EXPECT_FALSE(ageing.is_rate_and_state()) << level;
  }
  EXPECT_EQ(name(find_law(ageing_tests(0.0))), "ageing");
}

/// Friction that rises with speed alone cannot stick and slip: it is another effect.
TEST(RateAndStates, AContactThatStrengthensWithSpeedIsNotNamed) {
  for (const double b : {0.0, 0.003, 0.009})
    EXPECT_FALSE(find_law(rate_and_state_tests(0.010, b)).is_rate_and_state()) << b;
}

/// D_c follows from the drop: with V t/D_c e times as large S − K is larger by b.
TEST(RateAndStates, TheDropTellsTheCriticalSlip) {
  std::vector<LawTest> tests = rate_and_state_tests(0.010, 0.025);
  const double longer = find_law(tests).rate_and_state->critical_slip_m;
  for (LawTest& test : tests) test.S->value += 0.025;
  const RateAndState shorter = *find_law(tests).rate_and_state;
  EXPECT_GT(longer, 0.0);
  // V grows with the drop, too: less than a factor of e.
  EXPECT_NEAR(std::log(longer / shorter.critical_slip_m), 1.0, 0.35);
  EXPECT_GT(shorter.within_factor, kCriticalSlipFactor);
}

/// From one below zero to a large one: ageing, then neither, then rate-and-state.
TEST(RateAndStates, ADirectEffectThatIsNotCertainLeavesTheLawOpen) {
  std::string order;
  for (double a = -0.004; a < 0.006; a += 2e-5) {
    const FrictionLaw found = find_law(rate_and_state_tests(a, 0.010));
    const char now = found.is_rate_and_state() ? 'r' : found.told ? 'a' : '?';
    if (now == '?') {
      EXPECT_NE(found.ageing.reason.find("rate-and-state"), std::string::npos);
    }
    if (now == 'r') {
      EXPECT_GT(a, 0.0);
    }
    if (order.empty() || order.back() != now) order += now;
  }
  EXPECT_EQ(order, "a?r");
}

TEST(RateAndStates, PullsAloneFastOnesOrOneSpeedTellNoDirectEffect) {
  const std::vector<LawTest> tests = rate_and_state_tests(0.010, 0.025);
  std::vector<LawTest> pulls(tests.begin(), tests.begin() + 4);
  pulls.insert(pulls.end(), pulls.begin(), pulls.end() - 1);
  EXPECT_FALSE(find_law(pulls).rate_and_state);
  std::vector<LawTest> one_speed(tests.begin() + 4, tests.end());
  for (std::size_t sheet = 10; sheet < 13; ++sheet) {
    one_speed.push_back(tests[1]);
    one_speed.back().sheet = sheet;
  }
  EXPECT_FALSE(find_law(one_speed).rate_and_state);
  std::vector<LawTest> fast = tests;
  for (std::size_t i = 0; i < 4; ++i) fast[i].stick_time_s = *fast[i].stick_time_s / 10.0;
  EXPECT_FALSE(find_law(fast).rate_and_state);
}

TEST(LawTests, ATestThatChangesItsSpeedCountsByItsRests) {
  analysis::MeasuredTest test;
  test.results.Q = analysis::Estimate::none(std::string{analysis::kSpeedChanges});
  test.results.mu_k = analysis::Estimate::of(0.3, 3e-4);
  test.results.mu_k.systematic_uncertainty = 4e-4;
  test.results.mu_s = analysis::Estimate::of(0.38, 1e-4);
  test.results.mu_s.systematic_uncertainty = 4e-4;
  const std::vector<analysis::MeasuredTest> ramp{test};
  ASSERT_EQ(tests_for_law(ramp).left_out.size(), 1U);
  test.rests = {{0.001, 0.1, 0.38, 1e-4, 0.0, 0.30, 2e-4, false},
                {0.001, 10.0, 0.42, 2e-3, 4e-4, 0.30, 2e-4, true}};
  const LawTests found = tests_for_law(std::vector{test});
  ASSERT_EQ(found.tests.size(), 2U);
  EXPECT_EQ(found.measured, (std::vector<std::size_t>{0, 0}));
  EXPECT_TRUE(found.left_out.empty());
  EXPECT_NEAR(found.tests[0].S->value, 0.38, 1e-12);
  EXPECT_NEAR(found.tests[0].S->error, 1e-4, 1e-12);
  EXPECT_NEAR(found.tests[0].S->systematic, 4e-4, 1e-12);
  EXPECT_NEAR(found.tests[0].K->error, 2e-4, 1e-12);
  EXPECT_FALSE(found.tests[0].held);
  EXPECT_TRUE(found.tests[1].held);
  EXPECT_FALSE(found.tests[1].K);
  EXPECT_NEAR(found.tests[1].S->value, 0.42, 1e-12);
  EXPECT_NEAR(found.tests[1].S->error, 2e-3, 1e-12);
  EXPECT_NEAR(found.tests[1].S->systematic, 8e-4, 1e-12);
  test.rests[0].K.reset();  // A slack coupling tells none.
  EXPECT_FALSE(tests_for_law(std::vector{test}).tests[0].K);
  test.rests.clear();
  test.results.Q = analysis::Estimate::none("no fit");
  test.speed_changes = true;
  EXPECT_THAT(tests_for_law(std::vector{test}).left_out[0].reason,
              testing::StartsWith("the pull speed changes"));
  test.rests = {{0.001, 0.1, 0.38, 1e-4, 0.0, 0.30, 2e-4, false}};
  EXPECT_EQ(tests_for_law(std::vector{test}).tests.size(), 1U);  // Turning points tell no Q.
  test.rests = {{0.001, 0.1, 0.38, 1e-4, 0.0, 0.30, 2e-4, false}};
  test.speed_changes = false;
  test.results.Q = analysis::Estimate::of(0.2);
  EXPECT_EQ(tests_for_law(std::vector{test}).tests.size(), 0U);  // One speed, and no pull speed.
}

}  // namespace
}  // namespace stickslip::law
