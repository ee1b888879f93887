// Effects of the motion stage as scenes list them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "core/sim/scene.hpp"
#include "core/sim/scene_run.hpp"
#include "core/sim/scene_truth.hpp"
#include "tests/unit/scene_text.hpp"

namespace stickslip::sim {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

/// Eighteen lines; the next table starts on line 19.
const std::string kWholePull = R"(description = "d"
seed = 11
[tester]
sled_mass = "2331 g"
frequency = "20 Hz"
load_cell_gain = "2 N/V"
[paper]
mu_s = 0.35
mu_k = 0.30
[effects.constant_speed]
idle = "0.1 s"
pull_speed = "12 in/min"
pull = "3 s"
stop = "0.2 s"
return_speed = "12 in/min"
return = "0.5 s"
rest = "0.1 s"
[effects.one_way_coupling]
)";

Scene scene_with(const std::string& effects) {
  return parse_scene(kWholePull + effects, "test.toml").value();
}

base::LongColumn<model::TrueCycle> cycles(const Scene& scene, std::uint64_t seed = 11) {
  return scene_truth(scene, 350.0, seed).cycles;
}

Scene shipped(const std::string& name) {
  return load_scene(std::filesystem::path(STICKSLIP_SOURCE_DIR) / "config/scenes" / (name + ".toml")).value();
}

TEST(SceneScatter, TruthHasSAndKOfEachCycle) {
  const Scene scene = scene_with("[effects.scatter]\ndelta_mu_cv = 0.4\nmu_k_sd = 0.01\n");
  EXPECT_EQ(scene.paper.scatter->correlation_length_m, 0.001);
  EXPECT_THAT(SceneRun(scene, 350.0).effects(), Contains("scatter"));
  const auto all = cycles(scene);
  ASSERT_GT(all.size(), 20U);
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_NE(all[i].mu_s, all[i - 1].mu_s);
    EXPECT_NE(all[i].mu_k, all[i - 1].mu_k);
    EXPECT_GE(all[i].mu_s, all[i].mu_k);
  }
}

TEST(SceneScatter, HasItsOwnNumbersFromTheSeed) {
  const std::string scatter = "[effects.scatter]\ndelta_mu_cv = 0.4\n";
  const auto same = [](const auto& a, const auto& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
      return x.onset_time_s == y.onset_time_s && x.mu_s == y.mu_s && x.mu_k == y.mu_k;
    });
  };
  const auto alone = cycles(scene_with(scatter));
  EXPECT_TRUE(same(alone, cycles(scene_with(scatter + "[effects.white_noise]\nsd = 0.01\n"))));
  EXPECT_TRUE(same(alone, cycles(scene_with(scatter + "[effects.first_peak]\nchange = 0\n"))));
  EXPECT_FALSE(same(alone, cycles(scene_with(scatter), 12)));
}

TEST(SceneScatter, RunPlaysWhatTheTruthTells) {
  const Scene scene = scene_with("[effects.scatter]\ndelta_mu_cv = 0.5\nmu_k_sd = 0.01\n");
  SceneRun run{scene, 1e5};
  run.restart(99);
  std::vector<double> volts(static_cast<std::size_t>(scan_count(scene, 1e5)));
  run.next(volts);
  const double coefficient_per_volt = 2.0 / (2.331 * 9.80665);
  int stuck = 0;
  for (const auto& cycle : scene_truth(scene, 1e5, 99).cycles) {
    const double c = volts[static_cast<std::size_t>(cycle.onset_time_s * 1e5)] * coefficient_per_volt;
    // Up to one scan before the onset: r/rate = 8.2/1e5. Places too weak to hold are above.
    if (c < cycle.mu_s + 1e-9 && c > cycle.mu_s - 1e-4) ++stuck;
    EXPECT_GT(c, cycle.mu_s - 1e-4);
  }
  EXPECT_GT(stuck, 20);
}

TEST(SceneScatter, MistakesAreNamed) {
  EXPECT_EQ(refusal_of(kWholePull), "");
  EXPECT_THAT(refusal_of(kWholePull + "[effects.scatter]\ndelta_mu_cv = 0.7\n"),
              AllOf(HasSubstr("test.toml:20"), HasSubstr("0.7"), HasSubstr("0.6")));
  EXPECT_THAT(refusal_of(kWholePull + "[effects.scatter]\n"), HasSubstr("delta_mu_cv"));
  EXPECT_THAT(
      refusal_of(kWholePull + "[effects.scatter]\ndelta_mu_cv = 0.3\ncorrelation_length = \"0 mm\"\n"),
      AllOf(HasSubstr("test.toml:21"), HasSubstr("0 mm")));
  EXPECT_THAT(refusal_of(kWholePull + "[effects.scatter]\ndelta_mu_cv = 0.3\nmu_k_sd = -1\n"),
              HasSubstr("-1"));
}

TEST(SceneFirstPeak, ChangesTheFirstCycleAndItsTruth) {
  const auto changed = cycles(scene_with("[effects.first_peak]\nchange = 0.05\n"));
  ASSERT_GT(changed.size(), 10U);
  EXPECT_EQ(changed[0].mu_s, 0.35 + 0.05);
  for (std::size_t i = 1; i < changed.size(); ++i) EXPECT_EQ(changed[i].mu_s, 0.35);
  EXPECT_THAT(refusal_of(kWholePull + "[effects.first_peak]\n"), HasSubstr("change"));
  EXPECT_THAT(refusal_of(kWholePull + "[effects.first_peak]\nchange = 0.1\nsd = -0.1\n"),
              HasSubstr("test.toml:21"));
}

TEST(SceneContactAgeing, TruthHasTheSThatGaveWay) {
  const Scene scene = scene_with("[effects.contact_ageing]\nper_decade = 0.01\n");
  EXPECT_EQ(scene.paper.contact_ageing->cutoff_s, 0.001);
  EXPECT_THAT(SceneRun(scene, 350.0).effects(), Contains("contact_ageing"));
  const auto all = cycles(scene);
  ASSERT_GT(all.size(), 20U);
  EXPECT_GT(all[0].mu_s, all[2].mu_s);  // The first contact rests longest.
  EXPECT_GT(all[2].mu_s, 0.35);
  EXPECT_THAT(refusal_of(kWholePull + "[effects.contact_ageing]\nper_decade = -0.1\n"), HasSubstr("-0.1"));
  EXPECT_THAT(refusal_of(kWholePull + "[effects.contact_ageing]\nper_decade = 0.1\ncutoff = \"0 s\"\n"),
              AllOf(HasSubstr("test.toml:21"), HasSubstr("0 s")));
}

TEST(SceneOnsetConvention, IsSpringUnlessAskedForTheDamperToo) {
  const std::string damping = "[effects.damping]\ngamma_over_2omega = 0.022\n";
  const auto first_onset_s = [&](const std::string& effects) {
    return cycles(scene_with(damping + effects)).front().onset_time_s;
  };
  const double spring_s = first_onset_s("");
  EXPECT_EQ(first_onset_s("[effects.onset_convention]\nforce = \"spring\"\n"), spring_s);
  // Earlier by (γ v/g)/r = γ/ω₀²: γ = 2 · 0.022 ω.
  const double omega = 2.0 * std::acos(-1.0) * 20.0;
  const double earlier_s = 2.0 * 0.022 / (omega * (1.0 + 0.022 * 0.022));
  EXPECT_NEAR(spring_s - first_onset_s("[effects.onset_convention]\nforce = \"spring-and-damper\"\n"),
              earlier_s, 1e-14);
  EXPECT_THAT(refusal_of(kWholePull + "[effects.onset_convention]\nforce = \"wind\"\n"),
              AllOf(HasSubstr("wind"), HasSubstr("spring-and-damper")));
  EXPECT_THAT(refusal_of(kWholePull + "[effects.onset_convention]\n"), HasSubstr("force"));
}

TEST(ShippedScenes, AgeingContactsAreStrongestAfterTheLongestRest) {
  const model::TestTruth truth = scene_truth(shipped("contact-ageing"), 350.0, 1);
  EXPECT_EQ(truth.regime, model::Regime::kStickSlip);
  ASSERT_GT(truth.cycles.size(), 20U);
  EXPECT_GT(truth.cycles[0].mu_s, truth.cycles[5].mu_s + 0.005);
}

TEST(ShippedScenes, OnsetBySpringAndDamperSticksAndSlips) {
  const model::TestTruth truth = scene_truth(shipped("onset-by-spring-and-damper"), 350.0, 1);
  EXPECT_EQ(truth.regime, model::Regime::kStickSlip);
  EXPECT_GT(truth.cycles.size(), 20U);
}

TEST(ShippedScenes, ScatteredPaperIsMixedOrSticksAndSlips) {
  const model::TestTruth truth = scene_truth(shipped("scattered-paper"), 350.0, 1);
  EXPECT_GT(truth.cycles.size(), 20U);
  EXPECT_TRUE(truth.regime == model::Regime::kStickSlip || truth.regime == model::Regime::kMixed);
}

TEST(ShippedScenes, AbnormalFirstPeakStandsOut) {
  const model::TestTruth truth = scene_truth(shipped("abnormal-first-peak"), 350.0, 1);
  ASSERT_GT(truth.cycles.size(), 20U);
  EXPECT_GT(truth.cycles[0].mu_s, truth.cycles[1].mu_s + 0.02);
}

}  // namespace
}  // namespace stickslip::sim
