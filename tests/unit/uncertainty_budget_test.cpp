// The parts of a systematic uncertainty make its total, and a budget says of each source what is known.

#include "core/analysis/uncertainty_budget.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "core/analysis/group_budget.hpp"
#include "core/analysis/ladder.hpp"

namespace stickslip::analysis {
namespace {

using enum UncertaintySource;
using testing::HasSubstr;

constexpr std::size_t kBudgetDeltaMu = kBudgetQuantities[0];
constexpr std::size_t kBudgetStatic = kBudgetQuantities[1];
constexpr std::size_t kBudgetKinetic = kBudgetQuantities[2];

const BudgetLine& line_of(const UncertaintyBudget& budget, std::string_view source) {
  const auto found = std::ranges::find(budget.lines, source, &BudgetLine::source);
  if (found == budget.lines.end()) throw std::runtime_error("no such line: " + std::string{source});
  return *found;
}

bool has_line(const UncertaintyBudget& budget, std::string_view source) {
  return std::ranges::find(budget.lines, source, &BudgetLine::source) != budget.lines.end();
}

UncertaintyBudget budget_of(const TestResults& results, std::size_t quantity, const BudgetFacts& facts = {}) {
  return test_budget(results, quantities()[quantity], facts).value();
}

/// S − K with a gain and two parts of the model, static and kinetic with a gain and a zero.
TestResults calibrated() {
  TestResults results;
  results.rung = Rung::kTwoParameterLaw;
  results.smallest_slip = Estimate::of(12.0 * 0.0005);
  results.delta_mu = Estimate::of(0.05, 0.003);
  add_systematic(results.delta_mu, {{kDamping, 0.001}, {kCreep, 0.003}});
  add_systematic(results.delta_mu, kCalibration, 0.003);
  results.static_coefficient = Estimate::of(0.38);
  results.kinetic_coefficient = Estimate::of(0.3);
  for (Estimate* estimate : {&results.static_coefficient, &results.kinetic_coefficient}) {
    add_systematic(*estimate, kCalibration, 0.003);
    add_systematic(*estimate, kZero, 0.004);
  }
  return results;
}

TEST(SystematicParts, OfTheModelAddAndOfCalibrationAndZeroInQuadrature) {
  Estimate estimate = Estimate::of(0.3);
  add_systematic(estimate, kRung, -0.02);
  add_systematic(estimate, {{kDamping, 0.005}, {kCreep, 0.005}});
  EXPECT_DOUBLE_EQ(estimate.systematic_uncertainty.value(), 0.03);
  add_systematic(estimate, kCalibration, -0.04);
  EXPECT_DOUBLE_EQ(estimate.systematic_uncertainty.value(), 0.05);
  EXPECT_EQ(estimate.systematic_parts[kRung], 0.02);
  EXPECT_EQ(estimate.systematic_parts[kCalibration], 0.04);
  EXPECT_FALSE(estimate.systematic_parts[kZero]);
  EXPECT_DOUBLE_EQ(total_of(estimate.systematic_parts), 0.05);
  // M/u = 0.6: of what adds, 0.02 contributes 0.012; of the gain 0.04² / 0.05.
  const Contributions contributions = contributions_of(estimate);
  EXPECT_NEAR(contributions.of[static_cast<std::size_t>(kRung)], 0.012, 1e-15);
  EXPECT_NEAR(contributions.of[static_cast<std::size_t>(kCalibration)], 0.032, 1e-15);
  EXPECT_EQ(contributions.unnamed, 0.0);
}

TEST(SystematicParts, OfNoValueAreNone) {
  Estimate estimate = Estimate::none("no slip");
  add_systematic(estimate, kZero, 0.1);
  note_no_systematic(estimate, kZero);
  EXPECT_EQ(estimate, Estimate::none("no slip"));
}

TEST(SystematicParts, KnownToBeNoneLeaveAnUnknownTotalUnknown) {
  Estimate estimate = Estimate::of(0.3);
  note_no_systematic(estimate, kZero);
  EXPECT_EQ(estimate.systematic_parts[kZero], 0.0);
  EXPECT_FALSE(estimate.systematic_uncertainty);
}

// S by its bound is as far above K as S − K, with the parts of K beside its own.
TEST(SystematicParts, OfABoundAreThatAndForSThoseOfK) {
  TestResults results;
  results.mu_k = Estimate::of(0.3, 0.001);
  add_systematic(results.mu_k, kCorrection, 0.01);
  tell_bound(0.04, results);
  EXPECT_EQ(results.delta_mu.systematic_parts[kBound], 0.02);
  EXPECT_EQ(results.mu_s.systematic_parts[kCorrection], 0.01);
  EXPECT_EQ(results.mu_s.systematic_parts[kBound], 0.02);
  EXPECT_DOUBLE_EQ(results.mu_s.systematic_uncertainty.value(), 0.03);
}

TEST(Budget, CombinesRandomAndSystematicParts) {
  const UncertaintyBudget budget = budget_of(calibrated(), kBudgetDeltaMu);
  // √(0.003² + (0.001 + 0.003)² + 0.003²)
  EXPECT_DOUBLE_EQ(budget.combined.value(), std::sqrt(34e-6));
  EXPECT_DOUBLE_EQ(budget.expanded().value(), 2.0 * std::sqrt(34e-6));
  EXPECT_NEAR(budget.share_of(line_of(budget, "noise")), 9.0 / 34.0, 1e-12);
  EXPECT_NEAR(budget.share_of(line_of(budget, "damping")), 4.0 / 34.0, 1e-12);
  EXPECT_NEAR(budget.share_of(line_of(budget, "creep")), 12.0 / 34.0, 1e-12);
  EXPECT_NEAR(budget.share_of(line_of(budget, "calibration")), 9.0 / 34.0, 1e-12);
  EXPECT_EQ(line_of(budget, "noise").type, 'A');
  EXPECT_EQ(line_of(budget, "calibration").type, 'B');
  EXPECT_EQ(line_of(budget, "zero").state, BudgetState::kNone) << "it cancels";
  EXPECT_EQ(line_of(budget, "speed").state, BudgetState::kNone) << "the fit finds it";
  EXPECT_EQ(budget.unknown(), "replicates");
}

TEST(Budget, TheStaticCoefficientHasTheNoiseOfOneScan) {
  const UncertaintyBudget budget = budget_of(calibrated(), kBudgetStatic);
  EXPECT_DOUBLE_EQ(line_of(budget, "noise").size.value(), 0.0005);
  EXPECT_DOUBLE_EQ(line_of(budget, "zero").size.value(), 0.004);
  EXPECT_NEAR(budget.combined.value(), std::hypot(0.0005, 0.005), 1e-15);
  EXPECT_EQ(line_of(budget, "model").state, BudgetState::kNone);
}

TEST(Budget, WhatIsNotKnownIsNoZero) {
  TestResults results;
  results.kinetic_coefficient = Estimate::of(0.3);
  const UncertaintyBudget budget = budget_of(results, kBudgetKinetic);
  EXPECT_FALSE(budget.combined);
  EXPECT_FALSE(budget.expanded());
  EXPECT_EQ(budget.unknown(), "noise, replicates, calibration, zero, pull speed");
  EXPECT_THAT(line_of(budget, "calibration").note, HasSubstr("stickslip calibrate"));
  note_no_systematic(results.kinetic_coefficient, kZero);
  EXPECT_EQ(line_of(budget_of(results, kBudgetKinetic), "zero").state, BudgetState::kNone);
  EXPECT_FALSE(test_budget(results, quantities()[kBudgetStatic], {})) << "there is no value";
}

// Records of before have the total alone.
TEST(Budget, APartThatNobodyNamedIsOneLine) {
  TestResults results;
  results.static_coefficient = Estimate::of(0.38);
  results.static_coefficient.systematic_uncertainty = 0.01;
  const UncertaintyBudget budget = budget_of(results, kBudgetStatic);
  EXPECT_EQ(line_of(budget, "unnamed").size, 0.01);
  EXPECT_EQ(line_of(budget, "calibration").state, BudgetState::kIncluded);
  EXPECT_EQ(budget.combined, 0.01);
  // Parts that do not make the total are not believed.
  results.static_coefficient.systematic_parts[kZero] = 0.005;
  EXPECT_EQ(line_of(budget_of(results, kBudgetStatic), "unnamed").size, 0.01);
  results.static_coefficient.systematic_parts[kZero] = 0.01;
  EXPECT_FALSE(has_line(budget_of(results, kBudgetStatic), "unnamed"));
}

TEST(Budget, OfAFileWithImpossibleErrorsHasNoFiniteNumber) {
  TestResults results;
  results.static_coefficient = Estimate::of(0.38);
  results.static_coefficient.systematic_uncertainty = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isinf(budget_of(results, kBudgetStatic).combined.value()));
  results.static_coefficient.systematic_uncertainty = std::nan("");
  EXPECT_FALSE(budget_of(results, kBudgetStatic).combined) << "not known";
}

TEST(Budget, TheResolutionIsInTheNoise) {
  const UncertaintyBudget budget = budget_of(calibrated(), kBudgetDeltaMu, {.step_coefficient = 0.001});
  const BudgetLine& line = line_of(budget, "resolution");
  EXPECT_EQ(line.state, BudgetState::kIncluded);
  EXPECT_NEAR(line.size.value(), 0.001 / std::sqrt(12.0), 1e-15);
  EXPECT_EQ(line.variance, 0.0);
}

// A window of 10 … 30 mm at 10 mm/s lies 2 s after its start, and 1 % earlier if the belt is 1 % faster.
TEST(Budget, TheSpeedShiftsAMeanOverATravelAndNoOther) {
  TestResults results = calibrated();
  results.drift_rate = Estimate::of(-0.1);
  results.pull_speed_measured = Estimate::of(0.0101);
  BudgetFacts facts{.pull_speed_m_per_s = 0.01, .method = model::Method{}};
  EXPECT_EQ(line_of(budget_of(results, kBudgetKinetic, facts), "speed").state, BudgetState::kNone);
  facts.method->kinetic_travel = model::TravelWindow{0.01, 0.03};
  EXPECT_NEAR(line_of(budget_of(results, kBudgetKinetic, facts), "speed").size.value(), 0.002, 1e-12);
  EXPECT_EQ(line_of(budget_of(results, kBudgetStatic, facts), "speed").state, BudgetState::kNone);
  results.pull_speed_measured = Estimate::none("not measured");
  EXPECT_EQ(line_of(budget_of(results, kBudgetKinetic, facts), "speed").state, BudgetState::kUnknown);
  results.rung = Rung::kTurningPoints;
  EXPECT_EQ(line_of(budget_of(results, kBudgetDeltaMu, facts), "speed").state, BudgetState::kIncluded);
}

std::vector<MeasuredTest> replicates(const std::vector<double>& statics) {
  std::vector<MeasuredTest> tests;
  for (const double value : statics) {
    MeasuredTest test;
    test.results = calibrated();
    *test.results.static_coefficient.value = value;
    tests.push_back(test);
  }
  return tests;
}

TEST(GroupBudget, ReplicatesReplaceTheNoiseAndLeaveTheSystematicParts) {
  const std::vector<MeasuredTest> tests = replicates({0.37, 0.38, 0.39});
  const SpeedGroup group = group_by_speed(tests).front();
  const UncertaintyBudget budget = group_budget(tests, group, kBudgetStatic).value();
  const double error = 0.01 / std::sqrt(3.0);
  EXPECT_NEAR(line_of(budget, "replicates").size.value(), error, 1e-15);
  EXPECT_EQ(line_of(budget, "noise").state, BudgetState::kIncluded);
  EXPECT_NEAR(line_of(budget, "zero").size.value(), 0.004, 1e-15);
  EXPECT_NEAR(budget.combined.value(), std::hypot(error, 0.005), 1e-15);
  EXPECT_DOUBLE_EQ(budget.value, 0.38);
  EXPECT_EQ(budget.unknown(), "") << "static depends on no speed";
}

// Two tests alone: Student's t with one degree of freedom is within ± 2 in 70.5 % of all cases.
TEST(GroupBudget, SaysHowLittleTwoCoversWithFewTests) {
  std::vector<MeasuredTest> tests = replicates({0.37, 0.39});
  for (MeasuredTest& test : tests)
    test.results.static_coefficient = Estimate::of(*test.results.static_coefficient.value);
  const SpeedGroup group = group_by_speed(tests).front();
  const UncertaintyBudget budget = group_budget(tests, group, kBudgetStatic).value();
  EXPECT_NEAR(budget.coverage.value(), 2.0 / std::numbers::pi * std::atan(2.0), 1e-12);
  const std::vector<MeasuredTest> alike = replicates({0.3799, 0.3801});
  EXPECT_FALSE(group_budget(alike, group_by_speed(alike).front(), kBudgetStatic)->coverage)
      << "the systematic part is nearly all";
}

TEST(GroupBudget, OfOneTestIsThatTests) {
  const std::vector<MeasuredTest> tests = replicates({0.37});
  const UncertaintyBudget budget = group_budget(tests, group_by_speed(tests).front(), kBudgetStatic).value();
  EXPECT_DOUBLE_EQ(line_of(budget, "noise").size.value(), 0.0005);
  EXPECT_EQ(budget.unknown(), "replicates");
}

TEST(GroupBudget, CountsTheTestsInWhichASourceIsNotKnown) {
  std::vector<MeasuredTest> tests = replicates({0.37, 0.39});
  tests[1].results.static_coefficient = Estimate::of(0.39);
  const UncertaintyBudget budget = group_budget(tests, group_by_speed(tests).front(), kBudgetStatic).value();
  EXPECT_THAT(line_of(budget, "calibration").note, HasSubstr("not known in 1 of 2 tests"));
  EXPECT_NEAR(line_of(budget, "calibration").size.value(), 0.003, 1e-15) << "as the group's: of those known";
}

// S − K of a group is the mean by cycle, with that mean's errors.
TEST(GroupBudget, OfSMinusKIsOfTheMeanByCycle) {
  std::vector<MeasuredTest> tests = replicates({0.37, 0.39});
  tests[0].slips = {.count = 2.0, .sum = 0.10, .square_sum = 1e-6};
  tests[1].slips = {.count = 6.0, .sum = 0.36, .square_sum = 1e-6};
  const SpeedGroup group = group_by_speed(tests).front();
  const UncertaintyBudget budget = group_budget(tests, group, kBudgetDeltaMu).value();
  EXPECT_DOUBLE_EQ(budget.value, *group.by_cycle.mean.value);
  EXPECT_EQ(line_of(budget, "replicates").size, group.by_cycle.mean.standard_error);
  EXPECT_NEAR(budget.combined.value(),
              std::hypot(*group.by_cycle.mean.standard_error, *group.by_cycle.mean.systematic_uncertainty),
              1e-15);
}

}  // namespace
}  // namespace stickslip::analysis
