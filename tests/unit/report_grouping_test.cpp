#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "core/report/grouping.hpp"

namespace stickslip::report {
namespace {

constexpr double kInPerMin = 0.0254 / 60.0;
constexpr std::size_t kStatic = 0;
constexpr std::size_t kDeltaMu = 4;

MeasuredTest test_at(std::optional<double> speed_m_per_s, double static_coefficient) {
  MeasuredTest test;
  test.pull_speed_m_per_s = speed_m_per_s;
  test.results.static_coefficient = friction::Estimate::of(static_coefficient);
  for (const Quantity& quantity : quantities()) {
    friction::Estimate& estimate = test.results.*quantity.estimate;
    if (!estimate.value) estimate = friction::Estimate::none("not in this test");
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

TEST(Grouping, KeepsTheReasonOfEachAbsentNumber) {
  std::vector<MeasuredTest> tests{test_at(1.0, 0.1), test_at(1.0, 0.2)};
  tests[1].results.static_coefficient = friction::Estimate::none("no peak");
  const SpeedGroup group = group_by_speed(tests).front();
  EXPECT_EQ(group.quantities[kStatic].tests, (std::vector<std::size_t>{0}));
  ASSERT_EQ(group.quantities[kStatic].absences.size(), 1U);
  EXPECT_EQ(group.quantities[kStatic].absences[0].test, 1U);
  EXPECT_EQ(group.quantities[kStatic].absences[0].reason, "no peak");
  EXPECT_FALSE(group.quantities[kDeltaMu].replicates);
  EXPECT_EQ(group.quantities[kDeltaMu].absences.size(), 2U);
}

TEST(Grouping, PoolsTheScatterAboutEachSpeedsOwnMean) {
  // s = 0.1/√2 at both speeds, however far apart the means.
  const std::vector<SpeedGroup> groups =
      group_by_speed(std::vector{test_at(1.0, 0.1), test_at(1.0, 0.2), test_at(2.0, 5.1), test_at(2.0, 5.2)});
  EXPECT_NEAR(pooled_over_groups(groups, kStatic).value(), 0.1 / std::sqrt(2.0), 1e-14);
  EXPECT_FALSE(pooled_over_groups(groups, kDeltaMu));
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
}  // namespace stickslip::report
