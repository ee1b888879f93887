#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "core/analysis/grouping.hpp"

namespace stickslip::analysis {
namespace {

constexpr double kInPerMin = 0.0254 / 60.0;
constexpr std::size_t kStatic = 0;
constexpr std::size_t kDeltaMu = 4;

MeasuredTest test_at(std::optional<double> speed_m_per_s, double static_coefficient) {
  MeasuredTest test;
  test.pull_speed_m_per_s = speed_m_per_s;
  test.results.static_coefficient = Estimate::of(static_coefficient);
  for (const Quantity& quantity : quantities()) {
    Estimate& estimate = test.results.*quantity.estimate;
    if (!estimate.value) estimate = Estimate::none("not in this test");
  }
  return test;
}

TEST(Grouping, PutsEqualSpeedsTogetherRisingAndUnknownOnesLast) {
  const std::vector<MeasuredTest> tests{test_at(12 * kInPerMin, 0.4), test_at({}, 0.3),
                                        test_at(3 * kInPerMin, 0.2), test_at(0.00508, 0.5),
                                        test_at(0.00127, 0.25)};
  const std::vector<SpeedGroup> groups = group_by_speed(tests);
  ASSERT_EQ(groups.size(), 3U);
  EXPECT_EQ(groups[0].tests, (std::vector<std::size_t>{2, 4}));
  EXPECT_EQ(groups[1].tests, (std::vector<std::size_t>{0, 3}));
  EXPECT_EQ(groups[2].tests, (std::vector<std::size_t>{1}));
  EXPECT_FALSE(groups[2].pull_speed_m_per_s);
  EXPECT_NEAR(groups[1].quantities[kStatic].replicates->mean, 0.45, 1e-15);
}

TEST(Grouping, SpeedsTwoPerCentApartAreTwo) {
  EXPECT_EQ(group_by_speed(std::vector{test_at(1.0, 0.1), test_at(1.009, 0.1)}).size(), 1U);
  EXPECT_EQ(group_by_speed(std::vector{test_at(1.0, 0.1), test_at(1.02, 0.1)}).size(), 2U);
}

TEST(Grouping, GradesAndRegimesArePooledOnlyIfAsked) {
  std::vector<MeasuredTest> tests{test_at(1.0, 0.1), test_at(1.0, 0.2), test_at(1.0, 0.3), test_at(1.0, 0.4)};
  tests[1].grade = "liner";
  tests[2].results.regime = model::Regime::kStickSlip;
  tests[3].results.regime = model::Regime::kMixed;
  const auto members = [&tests](Pooling pooling) {
    std::vector<std::vector<std::size_t>> lists;
    for (const SpeedGroup& group : group_by_speed(tests, pooling)) lists.push_back(group.tests);
    return lists;
  };
  using Lists = std::vector<std::vector<std::size_t>>;
  EXPECT_EQ(members({}), (Lists{{0}, {1}, {2, 3}}));
  EXPECT_EQ(members({.grades = true}), (Lists{{0, 1}, {2, 3}}));
  EXPECT_EQ(members({.regimes = true}), (Lists{{0, 2, 3}, {1}}));
  EXPECT_EQ(members({.grades = true, .regimes = true}), (Lists{{0, 1, 2, 3}}));
  const SpeedGroup all = group_by_speed(tests, {.grades = true, .regimes = true}).front();
  EXPECT_EQ(all.grades, (std::vector<std::string>{"", "liner"}));
  EXPECT_EQ(all.regimes, (std::vector<model::Regime>{model::Regime::kUndecided, model::Regime::kStickSlip,
                                                     model::Regime::kMixed}));
}

TEST(Grouping, KeepsTheReasonOfEachAbsentNumber) {
  std::vector<MeasuredTest> tests{test_at(1.0, 0.1), test_at(1.0, 0.2)};
  tests[1].results.static_coefficient = Estimate::none("no peak");
  const SpeedGroup group = group_by_speed(tests).front();
  EXPECT_EQ(group.quantities[kStatic].tests, (std::vector<std::size_t>{0}));
  ASSERT_EQ(group.quantities[kStatic].absences.size(), 1U);
  EXPECT_EQ(group.quantities[kStatic].absences[0].test, 1U);
  EXPECT_EQ(group.quantities[kStatic].absences[0].reason, "no peak");
  EXPECT_FALSE(group.quantities[kDeltaMu].replicates);
  EXPECT_EQ(group.quantities[kDeltaMu].absences.size(), 2U);
}

// The systematic part of a mean is not smaller than those of its tests, and an unknown one is not zero.
TEST(Grouping, MeansHaveTheMeanSystematicPartOfTheirTests) {
  std::vector<MeasuredTest> tests{test_at(1.0, 0.1), test_at(1.0, 0.2), test_at(1.0, 0.3), test_at(2.0, 0.4)};
  for (MeasuredTest& test : tests) {
    test.results.delta_mu = Estimate::of(0.05, 0.001);
    test.slips = {.count = 2.0, .sum = 0.1};
  }
  tests[0].results.static_coefficient.systematic_uncertainty = 0.002;
  tests[1].results.static_coefficient.systematic_uncertainty = 0.004;
  tests[0].results.delta_mu.systematic_uncertainty = 0.01;
  tests[1].results.delta_mu.systematic_uncertainty = 0.02;
  tests[1].slips = {};  // None after the first: it is not in the mean by cycle.
  const std::vector<SpeedGroup> groups = group_by_speed(tests);
  EXPECT_DOUBLE_EQ(groups[0].quantities[kStatic].systematic_uncertainty.value(), 0.003);
  EXPECT_DOUBLE_EQ(groups[0].quantities[kDeltaMu].systematic_uncertainty.value(), 0.015);
  EXPECT_DOUBLE_EQ(groups[0].by_cycle.mean.systematic_uncertainty.value(), 0.01);
  EXPECT_FALSE(groups[1].quantities[kStatic].systematic_uncertainty);
  EXPECT_FALSE(groups[1].by_cycle.mean.systematic_uncertainty);
}

TEST(Grouping, PoolsTheScatterAboutEachSpeedsOwnMean) {
  // s = 0.1/√2 at both speeds, however far apart the means.
  const std::vector<SpeedGroup> groups =
      group_by_speed(std::vector{test_at(1.0, 0.1), test_at(1.0, 0.2), test_at(2.0, 5.1), test_at(2.0, 5.2)});
  EXPECT_NEAR(pooled_over_groups(groups, kStatic).value(), 0.1 / std::sqrt(2.0), 1e-14);
  EXPECT_FALSE(pooled_over_groups(groups, kDeltaMu));
}

/// S − K of the slips of a test, none of them its first, and all captured but the last.
SlipSums slips_of(const std::vector<double>& delta_mu) {
  std::vector<detect::Cycle> cycles;
  for (const double value : delta_mu) {
    cycles.emplace_back();
    cycles.back().delta_mu = value;
    cycles.back().flags = detect::kCycleCaptured;
  }
  return slip_sums(cycles);
}

TEST(Grouping, PoolsTheSlipsOfEachSpeedByCycle) {
  std::vector<MeasuredTest> tests{test_at(1.0, 0.1), test_at(1.0, 0.2), test_at(2.0, 0.3)};
  tests[0].slips = slips_of({0.04});
  tests[1].slips = slips_of({0.06, 0.05, 0.07});
  const std::vector<SpeedGroup> groups = group_by_speed(tests);
  EXPECT_NEAR(*groups[0].by_cycle.mean.value, 0.22 / 4.0, 1e-15);  // The mean of the tests' is 0.05.
  EXPECT_EQ(groups[0].by_cycle.test_count, 2U);
  EXPECT_EQ(groups[0].by_cycle.slip_count, 4U);
  // Sums less the mean times slips: ∓0.015; n/(n − 1) = 2. Student's t of one degree of freedom: 12.706.
  const double error = std::sqrt(2.0 * 2.0 * 0.015 * 0.015) / 4.0;
  EXPECT_NEAR(*groups[0].by_cycle.mean.standard_error, error, 1e-15);
  EXPECT_NEAR(mean_interval(groups[0].by_cycle).value().high, 0.055 + 12.7062047 * error, 1e-8);
  EXPECT_FALSE(groups[1].by_cycle.mean.value);
  EXPECT_FALSE(mean_interval(groups[1].by_cycle));
}

TEST(Pairing, ComparesTheMeansByCycleWithTheirErrors) {
  std::vector<MeasuredTest> a{test_at(1.0, 0.1), test_at(1.0, 0.2)};
  a[0].slips = slips_of({0.04});
  a[1].slips = slips_of({0.06, 0.05, 0.07});
  std::vector<MeasuredTest> b = a;
  b[0].slips = slips_of({0.03});
  b[1].slips = slips_of({0.05, 0.04, 0.06});
  const auto groups_a = group_by_speed(a);
  const auto groups_b = group_by_speed(b);
  const PooledComparison found = compare_pair_by_cycle(groups_a, groups_b, {1.0, 0, 0});
  ASSERT_TRUE(found.welch) << found.reason;
  EXPECT_NEAR(found.welch->difference, 0.01, 1e-15);
  EXPECT_NEAR(found.welch->t, 0.01 / (std::sqrt(2.0) * 0.0075), 1e-9);
  EXPECT_NEAR(found.welch->degrees_of_freedom, 2.0, 1e-9);
  b.pop_back();
  EXPECT_EQ(compare_pair_by_cycle(groups_a, group_by_speed(b), {1.0, 0, 0}).reason,
            "one test of B has such slips; two are needed");
  EXPECT_EQ(compare_pair_by_cycle(groups_a, groups_b, {1.0, 0, {}}).reason, "no test of B at this speed");
}

TEST(Pairing, FindsEqualSpeedsAndNamesTheSideWithout) {
  const std::vector<SpeedGroup> a = group_by_speed(
      std::vector{test_at(1.0, 0.1), test_at(1.0, 0.12), test_at(2.0, 0.3), test_at(2.0, 0.31)});
  const std::vector<SpeedGroup> b =
      group_by_speed(std::vector{test_at(2.001, 0.2), test_at(2.001, 0.21), test_at(0.5, 0.1)});
  const std::vector<SpeedPair> pairs = pair_speeds(a, b);
  ASSERT_EQ(pairs.size(), 3U);
  EXPECT_EQ(compare_pair(a, b, pairs[0], kStatic).reason, "no test of A at this speed");
  EXPECT_EQ(compare_pair(a, b, pairs[1], kStatic).reason, "no test of B at this speed");
  EXPECT_NEAR(compare_pair(a, b, pairs[2], kStatic).welch.value().difference, 0.1, 1e-15);
  EXPECT_EQ(compare_pair(a, b, pairs[2], kDeltaMu).reason, "no test of A has a value: not in this test");
}

TEST(Pairing, UnknownSpeedsAreOneGroup) {
  const std::vector<SpeedGroup> a = group_by_speed(std::vector{test_at({}, 0.1), test_at({}, 0.12)});
  const std::vector<SpeedPair> pairs = pair_speeds(a, a);
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_TRUE(pairs[0].a && pairs[0].b);
}

}  // namespace
}  // namespace stickslip::analysis
