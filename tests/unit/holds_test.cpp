#include "core/analysis/holds.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "core/analysis/rest_groups.hpp"
#include "core/model/belt_motion.hpp"

namespace stickslip::analysis {
namespace {

constexpr double kRate_Hz = 350.0;
constexpr double kSigma = 0.001;
constexpr double kPeak = 0.39;
constexpr double kTrough = 0.21;
constexpr double kRise_s = 0.1;
constexpr double kFall_s = 0.03;

/// A saw-tooth of twelve slips. In the rise to slip `at` the force stands still at `level`, or rises slowly.
struct Course {
  std::size_t at = 6;
  double still_s = 0.0;
  double level = 0.3;
  double creep = 0.0;      ///< Change of the force while it stands still.
  double roughness = 1.0;  ///< Scatter meanwhile, over that of the noise.

  double stop_s = 0.0;
  double go_s = 0.0;
  estimate::Trace trace{};
  base::LongColumn<detect::Fall> slips{};

  void draw() {
    std::mt19937_64 engine{7};
    std::normal_distribution<double> normal{0.0, kSigma};
    const auto add = [&](double value, double times) {
      trace.time_s.push_back(static_cast<double>(trace.size()) / kRate_Hz);
      trace.value.push_back(value + times * normal(engine));
      trace.usable.push_back(1);
    };
    const auto move = [&](double from, double to, double duration_s, bool slips_down, double times = 1.0) {
      const auto scans = static_cast<std::size_t>(std::lround(duration_s * kRate_Hz));
      for (std::size_t k = 0; k < scans; ++k) {
        const double part = static_cast<double>(k) / static_cast<double>(scans);
        const double shape = slips_down ? 0.5 - 0.5 * std::cos(std::numbers::pi * part) : part;
        add(from + (to - from) * shape, times);
      }
    };
    for (std::size_t i = 0; i < 12; ++i) {
      if (i == at && still_s > 0.0) {
        const double after = level + creep;
        move(kTrough, level, kRise_s * (level - kTrough) / (kPeak - kTrough), false);
        stop_s = static_cast<double>(trace.size()) / kRate_Hz;
        move(level, after, still_s, false, roughness);
        go_s = static_cast<double>(trace.size()) / kRate_Hz;
        move(after, kPeak, kRise_s * (kPeak - after) / (kPeak - kTrough), false);
      } else {
        move(kTrough, kPeak, kRise_s, false);
      }
      detect::Fall fall;
      fall.peak_at = static_cast<double>(trace.size());
      fall.peak = kPeak;
      move(kPeak, kTrough, kFall_s, true);
      fall.trough_at = static_cast<double>(trace.size());
      fall.trough = kTrough;
      slips.push_back(fall);
    }
    add(kTrough, 1.0);
  }
};

TEST(Holds, AreFoundWhereTheForceStandsStillBetweenTwoSlips) {
  constexpr double kScan_s = 1.0 / kRate_Hz;
  for (const double still_s : {0.3, 2.0, 30.0}) {
    for (const double level : {kTrough, 0.3, 0.36}) {
      Course course{.still_s = still_s, .level = level};
      course.draw();
      const std::vector<Hold> holds = find_holds(course.trace, course.slips, kSigma);
      ASSERT_EQ(holds.size(), 1U) << still_s << " s at " << level;
      // Six scans of a slope tell a time to a third of a scan; a stop in the slip itself leaves no slope.
      EXPECT_NEAR(holds[0].stop_s, course.stop_s, kScan_s) << level;
      EXPECT_NEAR(holds[0].go_s, course.go_s, kScan_s) << level;
    }
  }
}

TEST(Holds, OfAContactThatCreepsAreHoldsToo) {
  Course course{.still_s = 10.0, .level = 0.34, .creep = -0.03};
  course.draw();
  EXPECT_EQ(find_holds(course.trace, course.slips, kSigma).size(), 1U);
}

TEST(Holds, AreNotFoundInASawTooth) {
  Course course;
  course.draw();
  EXPECT_TRUE(find_holds(course.trace, course.slips, kSigma).empty());
}

TEST(Holds, AreNoSlowRises) {
  Course course{.still_s = 1.0, .level = 0.25, .creep = 0.1};
  course.draw();
  EXPECT_TRUE(find_holds(course.trace, course.slips, kSigma).empty());
}

TEST(Holds, AreNoSlidingOverRoughPaper) {
  Course course{.still_s = 2.0, .roughness = 3.0};
  course.draw();
  EXPECT_TRUE(find_holds(course.trace, course.slips, kSigma).empty());
}

TEST(Holds, AreNoSmoothSlidingThatWanders) {
  Course course{.still_s = 2.0};
  course.draw();
  for (std::size_t k = 0; k < course.trace.size(); ++k) {
    const double since_s = course.trace.time_s[k] - course.stop_s;
    if (since_s > 0.0 && since_s < 2.0) course.trace.value[k] += 5.0 * kSigma * std::sin(9.0 * since_s);
  }
  EXPECT_TRUE(find_holds(course.trace, course.slips, kSigma).empty());
}

TEST(Holds, NeedScansThatAreMeasurements) {
  Course course{.still_s = 2.0};
  course.draw();
  for (std::size_t k = 0; k < course.trace.size(); ++k) {
    const double since_s = course.trace.time_s[k] - course.stop_s;
    if (since_s > 0.0 && since_s < 2.0) course.trace.usable[k] = 0;
  }
  EXPECT_TRUE(find_holds(course.trace, course.slips, kSigma).empty());
}

TEST(Holds, AreNotSeenThroughABreak) {
  Course course{.still_s = 2.0};
  course.draw();
  course.trace.breaks.push_back(static_cast<std::size_t>((course.stop_s + 1.0) * kRate_Hz));
  EXPECT_TRUE(find_holds(course.trace, course.slips, kSigma).empty());
}

TEST(Holds, NeedSlipsThatTellHowLongARiseTakes) {
  Course course{.at = 2, .still_s = 2.0};
  course.draw();
  base::LongColumn<detect::Fall> few;
  for (std::size_t i = 0; i < 4; ++i) few.push_back(course.slips[i]);
  EXPECT_TRUE(find_holds(course.trace, few, kSigma).empty());
}

TEST(Holds, MakeACourseThatStandsStillInThem) {
  const auto course = course_with_holds(0.002, 1.0, {{3.0, 5.0}, {8.0, 9.5}});
  ASSERT_TRUE(course);
  for (const auto& [time_s, speed] : {std::pair{0.0, 0.002},
                                      {1.9, 0.002},
                                      {2.1, 0.0},
                                      {3.9, 0.0},
                                      {4.1, 0.002},
                                      {7.5, 0.0},
                                      {20.0, 0.002}}) {
    EXPECT_EQ(course->speed_m_per_s(time_s), speed) << time_s;
  }
}

TEST(Holds, AreKnownToTheBeltUnlessItGoesBack) {
  const auto still =
      model::PullSpeed::make({{0.0, 0.002}, {1.0, 0.002}, {1.0, 0.0}, {4.0, 0.0}, {4.0, 0.002}});
  const model::BeltMotion belt{*still, 10.0};
  EXPECT_FALSE(belt.held_from_s(0));
  ASSERT_TRUE(belt.held_from_s(1));
  EXPECT_DOUBLE_EQ(*belt.held_from_s(1), 11.0);
  const auto back = model::PullSpeed::make(
      {{0.0, 0.002}, {1.0, 0.002}, {1.0, -0.002}, {1.5, -0.002}, {1.5, 0.0}, {4.0, 0.0}, {4.0, 0.002}});
  EXPECT_FALSE((model::BeltMotion{*back, 0.0}.held_from_s(1)));
  EXPECT_TRUE(belt.has_one_speed());
  EXPECT_FALSE((model::BeltMotion{*back, 0.0}.has_one_speed()));
  const auto ramp = model::PullSpeed::make({{0.0, 0.0}, {8.0, 0.01}});
  EXPECT_FALSE((model::BeltMotion{*ramp, 0.0}.has_one_speed()));
}

TEST(BeltMotion, HasOneSpeedWhereTheTraceGoesOnForTenTimesTheStart) {
  const auto start = model::PullSpeed::make({{0.0, 0.0}, {0.5, 0.002}});
  EXPECT_FALSE((model::BeltMotion{*start, 10.0}.has_one_speed()));
  EXPECT_FALSE((model::BeltMotion{*start, 10.0, 15.4}.has_one_speed()));
  EXPECT_TRUE((model::BeltMotion{*start, 10.0, 15.6}.has_one_speed()));
  // A stop that lasts is no pull.
  const auto stops = model::PullSpeed::make({{0.0, 0.0}, {0.5, 0.002}, {1.0, 0.002}, {1.0, 0.0}});
  EXPECT_FALSE((model::BeltMotion{*stops, 10.0, 100.0}.has_one_speed()));
}

/// Six slips at each of two speeds, K of which differ by 0.01, and one after a hold.
std::vector<RestedSlip> two_speeds() {
  std::vector<RestedSlip> slips;
  for (const double turn : {-1.0, 1.0, -1.0, 1.0, -1.0, 1.0}) {
    slips.push_back({0.001, 0.1, 0.08 + 0.002 * turn, 0.001, 0.38, 0.22, false});
    slips.push_back({0.004, 0.025, 0.07, 0.001, 0.38, 0.24, false});
  }
  slips.push_back({0.001, 10.0, 0.12, 0.001, 0.42, 0.18, true});
  return slips;
}

TestResults results_with(double K) {
  TestResults results;
  results.rung = Rung::kTwoParameterLaw;
  results.mu_k = Estimate::of(K, 0.0001);
  results.delta_mu = Estimate::of(0.075, 0.0001);
  results.omega = Estimate::of(100.0, 0.1);
  results.gamma_over_2omega = Estimate::of(0.0, 0.001);
  return results;
}

TEST(RestGroups, AreTheSlipsOfASpeedAndEachSlipAfterAHold) {
  const std::vector<RestGroup> groups = group_by_rest(two_speeds(), results_with(0.305));
  ASSERT_EQ(groups.size(), 3U);
  EXPECT_FALSE(groups[0].held);
  EXPECT_NEAR(groups[0].stick_time_s, 0.1, 1e-12);
  // Without damping K is the middle of a fall: 0.30 and 0.31 about their mean, the K of the test.
  EXPECT_NEAR(*groups[0].K, 0.30, 1e-12);
  EXPECT_NEAR(*groups[2].K, 0.31, 1e-12);
  EXPECT_NEAR(groups[0].S, 0.30 + 0.08, 1e-12);
  EXPECT_NEAR(groups[0].S_error, 0.002 * std::sqrt(6.0 / 5.0) / std::sqrt(6.0), 1e-12);
  EXPECT_TRUE(groups[1].held);
  EXPECT_EQ(groups[1].stick_time_s, 10.0);
  EXPECT_NEAR(groups[1].S, 0.30 + 0.12, 1e-12);
  EXPECT_NEAR(*groups[1].K, 0.30, 1e-12);
  // A single slip scatters as those at its speed do.
  EXPECT_NEAR(groups[1].S_error, 0.002 * std::sqrt(6.0 / 5.0), 1e-12);
  // The errors of single slips, 1/80 of their S - K, are one for all: they count where S - K differs from the
  // test's.
  EXPECT_NEAR(groups[0].S_systematic, 0.001 / 0.08 * (0.08 - 0.075), 1e-12);
  EXPECT_NEAR(groups[1].S_systematic, 0.001 / 0.08 * (0.12 - 0.075), 1e-12);
}

TEST(RestGroups, ByTurningPointsHaveTheSOfTheirPeaks) {
  std::vector<RestedSlip> slips = two_speeds();
  for (RestedSlip& slip : slips) slip.delta_mu_error = std::nan("");
  TestResults results = results_with(0.305);
  EXPECT_TRUE(group_by_rest(slips, results).empty()) << "no fit that needs no error";
  results.rung = Rung::kTurningPoints;
  EXPECT_TRUE(group_by_rest(slips, results).empty()) << "no S of the test";
  // At 0.001 m/s the force overshoots S − K, 0.06 and 0.13, by u = 0.03; four times as fast by four times as
  // much.
  const double u = 0.03;
  const auto peak = [](double K, double delta_mu, double speed_u) {
    return K + std::hypot(delta_mu, speed_u);
  };
  slips.clear();
  for (int i = 0; i < 6; ++i)
    slips.push_back({0.001, 0.1, 0.06, std::nan(""), peak(0.3, 0.06, u), 0.22, false});
  slips.push_back({0.001, 10.0, std::nan(""), std::nan(""), peak(0.3, 0.13, u), 0.0, true});
  results.mu_k = Estimate::of(0.3, 0.001);
  results.mu_s = Estimate::of(0.36, 0.001);
  std::vector<RestGroup> groups = group_by_rest(slips, results);
  ASSERT_EQ(groups.size(), 2U);
  EXPECT_NEAR(groups[0].S, 0.36, 1e-12);
  EXPECT_TRUE(groups[1].held);
  EXPECT_NEAR(groups[1].S, 0.43, 1e-12);
  EXPECT_NEAR(groups[0].S_systematic, 0.0, 1e-12);
  EXPECT_NEAR(groups[1].S_systematic, 0.07 - (std::hypot(0.13, u) - std::hypot(0.06, u)), 1e-12);
  EXPECT_EQ(groups[0].K, 0.3);
  // A single slip scatters as those at its speed do, a mean less.
  for (std::size_t i = 0; i < 6; ++i) slips[i].peak += i % 2 == 0 ? 0.003 : -0.003;
  groups = group_by_rest(slips, results);
  EXPECT_NEAR(groups[0].S_error, 0.003 * std::sqrt(6.0 / 5.0) / std::sqrt(6.0), 1e-12);
  EXPECT_NEAR(groups[1].S_error, 0.003 * std::sqrt(6.0 / 5.0), 1e-12);
  // Without a K of the test S is told all the same: all peaks overshoot alike then.
  results.mu_k = Estimate::none("slack");
  groups = group_by_rest(slips, results);
  EXPECT_FALSE(groups[1].K);
  EXPECT_NEAR(groups[1].S, 0.36 + peak(0.3, 0.13, u) - peak(0.3, 0.06, u), 1e-12);
  EXPECT_NEAR(groups[1].S_systematic, 0.0, 1e-12);
}

TEST(RestGroups, OfPartlySlackSpeedsHaveTheirKFromFourSlipsThatWereNot) {
  std::vector<RestedSlip> slips;
  for (int i = 0; i < 6; ++i) {
    slips.push_back({0.001, 0.1, 0.08, std::nan(""), 0.38, 0.22, false});
    // All but three went slack: their peaks are others, and their troughs tell no K.
    const bool slack = i >= 3;
    slips.push_back({0.004, 0.03, slack ? std::nan("") : 0.08, std::nan(""), slack ? 0.44 : 0.38,
                     slack ? 0.0 : 0.22, false});
  }
  TestResults results = results_with(0.3);
  results.rung = Rung::kTurningPoints;
  results.mu_s =
      Estimate::of(0.38, 0.001);  // Of the slips that were not slack, whose peaks do not overshoot.
  const std::vector<RestGroup> groups = group_by_rest(slips, results);
  ASSERT_EQ(groups.size(), 2U);
  EXPECT_NEAR(groups[0].S, 0.38, 1e-12);
  EXPECT_NEAR(*groups[0].K, 0.3, 1e-12);
  EXPECT_FALSE(groups[1].K);
  EXPECT_NEAR(groups[1].S, 0.41, 1e-12);
}

TEST(RestGroups, TellWhetherThereAreSeveralSpeeds) {
  EXPECT_FALSE(have_several_speeds({}));
  std::vector<RestedSlip> slips{{0.001, 0.1, 0.08, 0.001, 0.38, 0.22, false},
                                {0.001 * 1.005, 0.1, 0.08, 0.001, 0.38, 0.22, false}};
  EXPECT_FALSE(have_several_speeds(slips)) << "as an encoder reads one";
  slips.push_back({0.002, 0.1, 0.08, 0.001, 0.38, 0.22, false});
  EXPECT_TRUE(have_several_speeds(slips));
}

TEST(RestGroups, NeedFourSlipsAtASpeedAndAK) {
  std::vector<RestedSlip> slips = two_speeds();
  EXPECT_TRUE(group_by_rest(slips, TestResults{}).empty());
  std::vector<RestedSlip> ramp;
  for (int i = 0; i < 20; ++i)
    ramp.push_back({0.001 * std::pow(1.002, i), 0.1, 0.08, 0.001, 0.38, 0.22, false});
  EXPECT_TRUE(group_by_rest(ramp, results_with(0.3)).empty());
  ramp.push_back({0.001, 10.0, 0.12, 0.001, 0.42, 0.18, true});
  EXPECT_TRUE(group_by_rest(ramp, results_with(0.3)).empty());
}

}  // namespace
}  // namespace stickslip::analysis
