// A ramp whose speed was measured by a second channel, not planned: the same results.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/support/scene_tests.hpp"

namespace stickslip {
namespace {

constexpr double kGain_m_per_s_per_V = 2e-3;
/// Of 16 bits over ±10 V.
constexpr double kStep_m_per_s = 20.0 / 65535.0 * kGain_m_per_s_per_V;

std::filesystem::path scene(const char* name) {
  return std::filesystem::path{STICKSLIP_SOURCE_DIR} / "config/scenes" / name;
}

test::AnalysedTest analyse(const char* name, std::optional<double> speed_gain_m_per_s_per_V) {
  const auto tests = test::analyse_scene(scene(name), 1, speed_gain_m_per_s_per_V);
  EXPECT_EQ(tests.size(), 1U);
  return tests.at(0);
}

TEST(SpeedChannel, RampEscapesAtTheSpeedOfItsPlan) {
  const auto plan = analyse("speed-ramp.toml", {});
  const auto channel = analyse("speed-ramp.toml", kGain_m_per_s_per_V);
  ASSERT_TRUE(plan.results.escape_speed.value) << plan.results.escape_speed.reason;
  ASSERT_TRUE(channel.results.escape_speed.value) << channel.results.escape_speed.reason;
  std::printf("escape at %.4f mm/s by the plan, %.4f by the channel; corrected %.4f +- %.4f, %.4f +- %.4f\n",
              1e3 * *plan.results.escape_speed.value, 1e3 * *channel.results.escape_speed.value,
              1e3 * *plan.results.escape_speed_corrected.value,
              1e3 * *plan.results.escape_speed_corrected.standard_error,
              1e3 * *channel.results.escape_speed_corrected.value,
              1e3 * *channel.results.escape_speed_corrected.standard_error);
  EXPECT_EQ(channel.results.regime, plan.results.regime);
  EXPECT_EQ(channel.results.cycle_count.value, plan.results.cycle_count.value);
  // By the plan, the belt's start is found from the loading: at 2.7/s and 0.001 of noise a scan, twenty scans
  // tell it to 0.1 ms; three times that on a ramp of 1.06 mm/s² is 0.3 µm/s, half a step of the channel.
  EXPECT_NEAR(*channel.results.escape_speed.value, *plan.results.escape_speed.value, kStep_m_per_s);
  EXPECT_NEAR(*channel.results.escape_speed_corrected.value, *plan.results.escape_speed_corrected.value,
              *plan.results.escape_speed_corrected.standard_error);
  EXPECT_NEAR(*channel.results.delta_mu.value, *plan.results.delta_mu.value,
              *plan.results.delta_mu.standard_error);
  ASSERT_EQ(channel.cycles.size(), plan.cycles.size());
  int compared = 0;
  for (std::size_t i = 0; i < plan.cycles.size(); ++i) {
    const double planned = plan.cycles[i].pull_speed_m_per_s;
    if (std::isnan(planned)) continue;
    EXPECT_NEAR(channel.cycles[i].pull_speed_m_per_s, planned, kStep_m_per_s) << i;
    ++compared;
  }
  EXPECT_GT(compared, 50);
}

TEST(SpeedChannel, SteadyPullKeepsItsResultsToTheLastBitAndItsCyclesGetTheSpeed) {
  const auto without = analyse("stick-slip-at-12-in-per-min.toml", {});
  const auto with = analyse("stick-slip-at-12-in-per-min.toml", kGain_m_per_s_per_V);
  EXPECT_EQ(with.results, without.results);
  ASSERT_EQ(with.cycles.size(), without.cycles.size());
  constexpr double kPullSpeed_m_per_s = 12.0 * 0.0254 / 60.0;
  int known = 0;
  for (std::size_t i = 0; i < with.cycles.size(); ++i) {
    EXPECT_TRUE(std::isnan(without.cycles[i].pull_speed_m_per_s));
    if (std::isnan(with.cycles[i].pull_speed_m_per_s)) continue;
    EXPECT_NEAR(with.cycles[i].pull_speed_m_per_s, kPullSpeed_m_per_s, kStep_m_per_s) << i;
    ++known;
  }
  EXPECT_GT(known, 50);
}

// Pulled, driven back until it is unloaded, pulled faster: each pull is a test.
TEST(SpeedChannel, EachPullOfThreeKnowsItsOwnSpeed) {
  const auto tests = test::analyse_scene(scene("three-speeds.toml"), 1, kGain_m_per_s_per_V);
  ASSERT_EQ(tests.size(), 3U);
  double inches_per_min = 3.0;
  for (const test::AnalysedTest& pull : tests) {
    int known = 0;
    for (const detect::Cycle& cycle : pull.cycles) {
      if (std::isnan(cycle.pull_speed_m_per_s)) continue;
      EXPECT_NEAR(cycle.pull_speed_m_per_s, inches_per_min * 0.0254 / 60.0, kStep_m_per_s);
      ++known;
    }
    EXPECT_GE(known, 1);  // Of a ring-down the first onset alone.
    inches_per_min *= 2.0;
  }
}

}  // namespace
}  // namespace stickslip
