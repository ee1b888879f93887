// Effects that say how the belt moves and how K drifts, as scenes list them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/sim/belt.hpp"
#include "core/sim/motion_solver.hpp"
#include "core/sim/scene.hpp"
#include "core/sim/scene_run.hpp"
#include "core/sim/scene_truth.hpp"
#include "tests/unit/scene_text.hpp"

namespace stickslip::sim {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Ten lines and a test of eight: the next table starts on line 19, unless the coupling is one-way: 20.
const std::string kPull =
    "description = \"d\"\n[tester]\nsled_mass = \"2331 g\"\nfrequency = \"20 Hz\"\nload_cell_gain = \"2 "
    "N/V\"\n"
    "[paper]\nmu_s = 0.35\nmu_k = 0.30\n[effects.damping]\ngamma_over_2omega = 0.022\n"
    "[effects.constant_speed]\nidle = \"0.5 s\"\npull_speed = \"5 mm/s\"\npull = \"4 s\"\nstop = \"1 s\"\n"
    "return_speed = \"5 mm/s\"\nreturn = \"1 s\"\nrest = \"0.5 s\"\n";
const std::string kOneWay = "[effects.one_way_coupling]\n";

std::vector<std::string_view> effects_of(const std::string& text) {
  const Scene scene = scene_of(text);
  return SceneRun{scene, 350.0}.effects();
}

double speed_at(const std::string& text, double time_s) {
  return belt_speed_m_per_s(motion_of(scene_of(text)).belt, time_s);
}

TEST(SceneSpeedRamp, GoesInALineOverThePull) {
  const std::string scene = kPull + "[effects.speed_ramp]\nto = \"1 mm/s\"\n";
  EXPECT_THAT(effects_of(scene), ElementsAre("damping", "constant_speed", "speed_ramp"));
  EXPECT_EQ(speed_at(scene, 0.25), 0.0);
  EXPECT_EQ(speed_at(scene, 0.5), 0.005);
  EXPECT_NEAR(speed_at(scene, 2.5), 0.003, 1e-17);
  EXPECT_NEAR(speed_at(scene, 4.5 - 1e-9), 0.001, 2e-12);
  EXPECT_EQ(speed_at(scene, 5.0), 0.0);
  EXPECT_EQ(speed_at(scene, 6.0), -0.005);
}

TEST(SceneExponentialStart, ApproachesThePullSpeed) {
  const std::string scene = kPull + "[effects.exponential_start]\ntime_constant = \"0.2 s\"\n";
  EXPECT_THAT(effects_of(scene), Contains("exponential_start"));
  EXPECT_EQ(speed_at(scene, 0.5), 0.0);
  EXPECT_NEAR(speed_at(scene, 0.7), 0.005 * (1.0 - std::exp(-1.0)), 1e-17);
  EXPECT_NEAR(speed_at(scene, 4.4), 0.005 * (1.0 - std::exp(-19.5)), 1e-17);
}

// 5 mm/s at 50 mm/s³ takes 2√0.1 s = 0.632 s; half the speed is reached halfway, at √(V j).
TEST(SceneJerkLimitedStart, TakesTwiceTheRootOfSpeedOverJerk) {
  const std::string scene = kPull + "[effects.jerk_limited_start]\njerk = \"50 mm/s^3\"\n";
  EXPECT_THAT(effects_of(scene), Contains("jerk_limited_start"));
  const double half_s = std::sqrt(0.1);
  EXPECT_NEAR(speed_at(scene, 0.5 + half_s / 2.0), 0.005 / 8.0, 1e-17);
  EXPECT_NEAR(speed_at(scene, 0.5 + half_s), 0.0025, 1e-17);
  EXPECT_NEAR(speed_at(scene, 0.5 + 1.5 * half_s), 0.005 * 7.0 / 8.0, 1e-17);
  EXPECT_NEAR(speed_at(scene, 0.5 + 2.0 * half_s), 0.005, 1e-17);
  EXPECT_EQ(speed_at(scene, 4.4), 0.005);
  EXPECT_THAT(refusal_of(kPull + "[effects.jerk_limited_start]\njerk = \"1 mm/s^3\"\n"),
              AllOf(HasSubstr("test.toml:20"), HasSubstr("1 mm/s^3"), HasSubstr("at least 0.00125 m/s^3")));
}

// The sled sticks while the belt starts as gently as that: no slip at the start.
TEST(SceneStarts, GentleStartsBeginWithSticking) {
  for (const char* start : {"[effects.exponential_start]\ntime_constant = \"0.2 s\"\n",
                            "[effects.jerk_limited_start]\njerk = \"50 mm/s^3\"\n"}) {
    const model::TestTruth truth = scene_truth(scene_of(kPull + start), 350.0, 1);
    ASSERT_GE(truth.modes.size(), 2U);
    EXPECT_EQ(truth.modes[0].mode, model::Mode::kStick);
    EXPECT_GT(truth.modes[0].end_s, 0.55);
    ASSERT_FALSE(truth.cycles.empty());
    EXPECT_EQ(truth.modes[0].end_s, truth.cycles[0].onset_time_s);
  }
  const model::TestTruth abrupt = scene_truth(scene_of(kPull), 350.0, 1);
  EXPECT_EQ(abrupt.modes[0].end_s, 0.5);
}

const std::string kPoints =
    "description = \"d\"\nduration = \"6 s\"\n[tester]\nsled_mass = \"2331 g\"\nfrequency = \"20 Hz\"\n"
    "load_cell_gain = \"2 N/V\"\n[paper]\nmu_s = 0.35\nmu_k = 0.30\n[effects.piecewise_speed]\n";

TEST(ScenePiecewiseSpeed, GoesInLinesBetweenPoints) {
  const std::string scene =
      kPoints +
      "points = [{at = \"1 s\", speed = \"0 m/s\"}, {at = \"2 s\", speed = \"4 mm/s\"},\n"
      "  {at = \"3 s\", speed = \"4 mm/s\"}, {at = \"3 s\", speed = \"2 mm/s\"},\n"
      "  {at = \"5 s\", speed = \"0 m/s\"}]\n";
  EXPECT_EQ(speed_at(scene, 0.5), 0.0);
  EXPECT_NEAR(speed_at(scene, 1.5), 0.002, 1e-17);
  EXPECT_EQ(speed_at(scene, 2.5), 0.004);
  EXPECT_NEAR(speed_at(scene, 4.0), 0.001, 1e-17);
  EXPECT_EQ(speed_at(scene, 5.5), 0.0);
  const auto pull = pull_of(scene_of(scene));
  ASSERT_TRUE(pull);
  EXPECT_EQ(pull->start_s, 1.0);
  EXPECT_EQ(pull->end_s, 5.0);
  EXPECT_EQ(steady_pull_speed_m_per_s(scene_of(scene)), std::nullopt);
  EXPECT_THAT(effects_of(scene), ElementsAre("piecewise_speed"));
  const model::TestTruth truth = scene_truth(scene_of(scene), 350.0, 1);
  ASSERT_FALSE(truth.cycles.empty());
  EXPECT_EQ(truth.pull_speed_m_per_s, speed_at(scene, truth.cycles[0].onset_time_s));
}

TEST(ScenePiecewiseSpeed, GoesOnAtItsLastSpeed) {
  const std::string scene = kPoints + "points = [{at = \"1 s\", speed = \"3 mm/s\"}]\n";
  EXPECT_EQ(speed_at(scene, 0.99), 0.0);
  EXPECT_EQ(speed_at(scene, 5.99), 0.003);
  EXPECT_EQ(pull_of(scene_of(scene))->end_s, 6.0);
}

TEST(ScenePiecewiseSpeed, MistakesAreNamed) {
  EXPECT_THAT(
      refusal_of(kPoints +
                 "points = [{at = \"2 s\", speed = \"3 mm/s\"},\n{at = \"1 s\", speed = \"0 m/s\"}]\n"),
      AllOf(HasSubstr("test.toml:12"), HasSubstr("1 s"), HasSubstr("2 s")));
  EXPECT_THAT(refusal_of(kPoints + "points = []\n"), AllOf(HasSubstr("test.toml:11"), HasSubstr("points")));
  EXPECT_THAT(refusal_of(kPoints + "points = [{at = \"2 s\"}]\n"), HasSubstr("speed"));
  EXPECT_THAT(refusal_of(kPoints + "points = [{at = \"2 s\", speed = \"30 m/s\"}]\n"), HasSubstr("30 m/s"));
  EXPECT_THAT(
      refusal_of(kPull + "[effects.piecewise_speed]\npoints = [{at = \"1 s\", speed = \"3 mm/s\"}]\n"),
      AllOf(HasSubstr("test.toml:19"), HasSubstr("constant_speed")));
}

TEST(SceneShapes, ExcludeEachOtherAndNeedAPull) {
  EXPECT_THAT(refusal_of(kPull + "[effects.speed_ramp]\nto = \"1 mm/s\"\n[effects.exponential_start]\n"
                                 "time_constant = \"1 s\"\n"),
              AllOf(HasSubstr("test.toml:21"), HasSubstr("speed_ramp"), HasSubstr("exponential_start")));
  EXPECT_THAT(
      refusal_of(kPoints +
                 "points = [{at = \"1 s\", speed = \"3 mm/s\"}]\n[effects.speed_ramp]\nto = \"1 mm/s\"\n"),
      AllOf(HasSubstr("test.toml:12"), HasSubstr("constant_speed")));
  EXPECT_THAT(refusal_of(kPull + "[effects.speed_ramp]\nto = \"-1 mm/s\"\n"),
              AllOf(HasSubstr("test.toml:20"), HasSubstr("-1 mm/s"), HasSubstr("from 0 m/s to 10 m/s")));
  EXPECT_THAT(refusal_of(kPull + "[effects.exponential_start]\ntime_constant = \"0 s\"\n"), HasSubstr("0 s"));
}

TEST(SceneStartupSlack, DelaysTheForce) {
  const std::string slack = "[effects.startup_slack]\nlength = \"1 mm\"\n";
  const std::string scene = kPull + kOneWay + slack;
  EXPECT_THAT(effects_of(scene),
              ElementsAre("damping", "constant_speed", "one_way_coupling", "startup_slack"));
  const model::TestTruth truth = scene_truth(scene_of(scene), 350.0, 1);
  ASSERT_GE(truth.modes.size(), 2U);
  EXPECT_EQ(truth.modes[0].mode, model::Mode::kSlack);
  // 1 mm at 5 mm/s after half a second; the sled loses v²/2Kg = 4.2 µm while it catches up with the belt.
  const double lost_m = 0.005 * 0.005 / (2.0 * 0.30 * 9.80665);
  EXPECT_NEAR(truth.modes[0].end_s, 0.5 + (0.001 + lost_m) / 0.005, 1e-13);
  EXPECT_THAT(refusal_of(kPull + slack), AllOf(HasSubstr("test.toml:19"), HasSubstr("one_way_coupling")));
  EXPECT_THAT(refusal_of(kPull + kOneWay + "[effects.startup_slack]\nlength = \"0 mm\"\n"),
              HasSubstr("0 mm"));
}

TEST(SceneKineticDrift, ReadsTimeOrTravel) {
  const Scene over_time = scene_of(kPull + "[effects.kinetic_drift]\nchange = -0.2\nover = \"8 s\"\n");
  EXPECT_EQ(over_time.kinetic_drift->over, KineticDrift::Over::kTime);
  EXPECT_EQ(over_time.kinetic_drift->form, KineticDrift::Form::kLinear);
  EXPECT_EQ(over_time.kinetic_drift->scale, 8.0);
  const Scene over_travel =
      scene_of(kPull + "[effects.kinetic_drift]\nchange = 0.2\nover = \"20 mm\"\ncourse = \"exponential\"\n");
  EXPECT_EQ(over_travel.kinetic_drift->over, KineticDrift::Over::kBeltTravel);
  EXPECT_EQ(over_travel.kinetic_drift->form, KineticDrift::Form::kExponential);
  EXPECT_EQ(over_travel.kinetic_drift->scale, 0.02);
  EXPECT_THAT((SceneRun{over_travel, 350.0}.effects()), Contains("kinetic_drift"));
}

// The truth has S and K of each cycle: K (1 − 0.2 t/8 s), and 0.05 more.
TEST(SceneKineticDrift, TruthHasTheDriftedCoefficients) {
  const Scene scene = scene_of(kPull + "[effects.kinetic_drift]\nchange = -0.2\nover = \"8 s\"\n");
  const model::TestTruth truth = scene_truth(scene, 350.0, 1);
  ASSERT_GT(truth.cycles.size(), 30U);
  for (const model::TrueCycle& cycle : truth.cycles) {
    const double K = 0.30 * (1.0 - 0.2 * cycle.onset_time_s / 8.0);
    EXPECT_NEAR(cycle.mu_k, K, 1e-15);
    EXPECT_NEAR(cycle.mu_s, K + 0.05, 1e-15);
  }
}

TEST(SceneKineticDrift, MistakesAreNamed) {
  const std::string drift = kPull + "[effects.kinetic_drift]\n";
  // The scene lasts 7 s.
  EXPECT_THAT(refusal_of(drift + "change = -1\nover = \"5 s\"\n"),
              AllOf(HasSubstr("test.toml:20"), HasSubstr("change = -1"), HasSubstr("mu_k"),
                    HasSubstr("at least -0.714286")));
  EXPECT_EQ(refusal_of(drift + "change = -0.714\nover = \"5 s\"\n"), "");
  // The belt goes forth 20 mm and back at most 5 mm.
  EXPECT_THAT(refusal_of(drift + "change = -1\nover = \"19 mm\"\n"), HasSubstr("at least -0.95"));
  EXPECT_EQ(refusal_of(drift + "change = -1\nover = \"21 mm\"\n"), "");
  EXPECT_THAT(refusal_of(drift + "change = 0.1\nover = \"3 N\"\n"),
              AllOf(HasSubstr("test.toml:21"), HasSubstr("3 N")));
  EXPECT_THAT(refusal_of(drift + "change = 0.1\nover = \"0 s\"\n"), HasSubstr("above 0"));
  EXPECT_THAT(refusal_of(drift + "change = 0.1\n"), HasSubstr("over"));
  EXPECT_THAT(refusal_of(drift + "change = 0.1\nover = \"3 s\"\ncourse = \"wild\"\n"), HasSubstr("wild"));
}

}  // namespace
}  // namespace stickslip::sim
