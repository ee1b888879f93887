#include "core/trend/tester_charts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <set>

#include "tests/support/trend_trials.hpp"

namespace stickslip::trend {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TestValues reference_test(double delta_mu, double pull_speed_m_per_s = 0.005) {
  TestValues test;
  test.sample = "ref";
  test.pull_speed_m_per_s = pull_speed_m_per_s;
  test.delta_mu = delta_mu;
  test.mu_k = 0.3;
  return test;
}

TestValues zero_test(double zero_N, int number) {
  TestValues test;
  test.time = "t" + std::to_string(number);
  test.file = std::to_string(number) + ".h5";
  test.values[static_cast<std::size_t>(Quantity::kZero)] = zero_N;
  return test;
}

TEST(ChartKinds, HaveEachANameAKeyAndACode) {
  std::set<std::string_view> names;
  for (const ChartKind& kind : chart_kinds()) {
    names.insert(kind.name);
    EXPECT_EQ(base::kind_of(kind.code).name, "trend-" + std::string{kind.name});
    EXPECT_EQ(kind_of(*quantity_from_name(kind.name)).code, kind.code);
  }
  EXPECT_EQ(names.size(), kQuantities);
  EXPECT_FALSE(quantity_from_name("colour"));
}

TEST(TesterCharts, LeaveAChartAsItIsWithoutAFiniteValue) {
  TesterCharts charts;
  charts.add(zero_test(0.1, 1));
  charts.add(zero_test(std::numeric_limits<double>::quiet_NaN(), 2));
  charts.add({});
  EXPECT_EQ(charts.state(Quantity::kZero).chart.count(), 1);
  EXPECT_EQ(charts.state(Quantity::kZero).latest_file, "1.h5");
  EXPECT_EQ(charts.state(Quantity::kNoise).verdict(), Verdict::kOff);
  EXPECT_THAT(charts.state(Quantity::kReference).no_value_reason, HasSubstr("[trend] reference"));
}

TEST(TesterCharts, NameTheTestAtTheOnsetOfAnAlarm) {
  int alarms = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random{seed};
    std::normal_distribution<double> normal;
    TesterCharts charts;
    ControlChart chart;
    for (int k = 0; k < 150; ++k) {
      const double zero_N = normal(random) + (k < 100 ? 0.0 : 1.5);
      const std::optional<ChartAlarm> alarm = chart.add(zero_N);
      charts.add(zero_test(zero_N, k));
      if (!alarm) continue;
      ++alarms;
      ASSERT_TRUE(charts.state(Quantity::kZero).alarm);
      EXPECT_EQ(charts.state(Quantity::kZero).alarm->since_file, std::to_string(alarm->onset) + ".h5")
          << "seed " << seed;
      EXPECT_EQ(charts.state(Quantity::kZero).alarm->told_file, std::to_string(k) + ".h5");
      break;
    }
  }
  EXPECT_GE(alarms, 15);
}

TEST(TesterCharts, CompareTheReferencePaperOfOneNameOneSpeedAndOneQuantity) {
  TesterCharts charts{"ref"};
  TestValues other = reference_test(0.05);
  other.sample = "liner";
  charts.add(other);
  EXPECT_EQ(charts.state(Quantity::kReference).chart.count(), 0);
  EXPECT_THAT(charts.state(Quantity::kReference).no_value_reason, HasSubstr("not the reference paper, ref"));
  charts.add(reference_test(0.05));
  charts.add(reference_test(0.06, 0.005 * 1.04));  // Within 5 % of the first.
  charts.add(reference_test(0.05, 0.005 * 1.06));
  EXPECT_EQ(charts.state(Quantity::kReference).chart.count(), 2);
  EXPECT_THAT(charts.state(Quantity::kReference).no_value_reason, HasSubstr("0.005 m/s"));
  TestValues without_slip = reference_test(0.0);
  without_slip.delta_mu.reset();
  charts.add(without_slip);
  EXPECT_EQ(charts.state(Quantity::kReference).chart.count(), 2);
  EXPECT_EQ(charts.state(Quantity::kReference).latest, 0.06);

  // A paper that does not slip at first has K on the chart; so has each later test.
  charts.restart(Quantity::kReference, false);
  charts.add(without_slip);
  charts.add(reference_test(0.05));
  EXPECT_EQ(charts.state(Quantity::kReference).chart.count(), 2);
  EXPECT_EQ(charts.state(Quantity::kReference).latest, 0.3);
}

TEST(TesterCharts, LetAnAlarmStandUntilItIsAcknowledged) {
  TesterCharts charts;
  int number = 0;
  for (; number < 100; ++number) charts.add(zero_test(number % 2 == 0 ? 0.1 : -0.1, number));
  EXPECT_THAT(charts.findings(), IsEmpty());
  std::vector<Quantity> alarmed;
  for (; alarmed.empty() && number < 120; ++number) alarmed = charts.add(zero_test(2.0, number));
  EXPECT_THAT(alarmed, ElementsAre(Quantity::kZero));
  for (int more = 0; more < 30; ++more) EXPECT_THAT(charts.add(zero_test(-9.0, ++number)), IsEmpty());
  ASSERT_EQ(charts.findings().size(), 1U);
  const base::Finding finding = charts.findings().front();
  EXPECT_EQ(finding.code, "trend-zero");
  // Around 0 before, with a standard deviation of 0.1 √(100/99).
  EXPECT_THAT(finding.text, HasSubstr("the zero rose by about 2 N (19.9 standard deviations)"));
  EXPECT_THAT(finding.text, HasSubstr("with the test of t100 (100.h5)"));
  EXPECT_EQ(charts.state(Quantity::kZero).verdict(), Verdict::kAlarm);

  TesterCharts false_alarm = charts;
  const std::int64_t count = charts.state(Quantity::kZero).chart.count();
  false_alarm.restart(Quantity::kZero, true);
  EXPECT_THAT(false_alarm.findings(), IsEmpty());
  EXPECT_EQ(false_alarm.state(Quantity::kZero).chart.count(), count);
  EXPECT_EQ(false_alarm.state(Quantity::kZero).verdict(), Verdict::kLearning);
  charts.restart(Quantity::kZero, false);
  EXPECT_EQ(charts.state(Quantity::kZero).chart.count(), 0);
  EXPECT_EQ(charts.state(Quantity::kZero).no_value_reason, "no test since the restart");
}

TEST(TesterCharts, KeepTheLatestTestsToDrawWithTheArmThatToldAnAlarm) {
  TesterCharts charts;
  for (int i = 0; i < 100; ++i) charts.add(zero_test(i % 2 == 0 ? 0.5 : 0.6, i));
  const std::deque<ChartPoint>& points = charts.state(Quantity::kZero).points;
  ASSERT_EQ(points.size(), 100U);
  EXPECT_EQ(points.back().file, "99.h5");
  EXPECT_EQ(points.back().value, 0.6);
  EXPECT_EQ(points.back().upper, charts.state(Quantity::kZero).chart.upper());
  EXPECT_EQ(points.back().lower, charts.state(Quantity::kZero).chart.lower());
  // The arm begins again at 0 with the alarm; what is drawn passes h.
  int number = 100;
  while (!charts.state(Quantity::kZero).alarm) charts.add(zero_test(-2.0, number++));
  EXPECT_GT(points.back().lower, kDecisionInterval);
  EXPECT_LT(points.at(points.size() - 2).lower, kDecisionInterval);
  EXPECT_EQ(points.back().upper, 0.0);
  while (number < 500) charts.add(zero_test(0.5, number++));
  EXPECT_EQ(points.size(), ChartState::kMostPoints);
  EXPECT_EQ(points.front().file, "300.h5");
  charts.restart(Quantity::kZero, true);
  EXPECT_EQ(points.size(), ChartState::kMostPoints);
  charts.restart(Quantity::kZero, false);
  EXPECT_TRUE(points.empty());
}

TEST(TesterCharts, LearnUntilTheBaselineIsFull) {
  TesterCharts charts;
  for (int number = 0; number < kFullBaseline; ++number) {
    EXPECT_NE(charts.state(Quantity::kZero).verdict(), Verdict::kInControl);
    charts.add(zero_test(number % 2 == 0 ? -0.1 : 0.1, number));
  }
  EXPECT_EQ(charts.state(Quantity::kZero).verdict(), Verdict::kInControl);
}

}  // namespace
}  // namespace stickslip::trend
