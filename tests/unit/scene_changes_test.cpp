#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/sim/scene.hpp"
#include "core/sim/scene_run.hpp"

namespace stickslip::sim {
namespace {

const std::filesystem::path kScene =
    std::filesystem::path(STICKSLIP_SOURCE_DIR) / "config" / "scenes" / "stick-slip-at-12-in-per-min.toml";

std::string refusal(const SceneChanges& changes) {
  const base::Result<Scene> scene = load_scene(kScene, changes);
  return scene ? "" : scene.error().message;
}

TEST(SceneChanges, AreTheOnlyDifference) {
  const Scene plain = *load_scene(kScene);
  const base::Result<Scene> scene =
      load_scene(kScene, {{{"paper.mu_s", "0.34", "--set paper.mu_s=0.34"}}, {}});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->mu_s, 0.34);
  EXPECT_EQ(scene->mu_k, plain.mu_k);
  EXPECT_EQ(scene->name, plain.name);
  EXPECT_EQ(scene->seed, plain.seed);
  EXPECT_EQ(scene->duration_s, plain.duration_s);
  EXPECT_EQ(scene->white_noise->sd_V, plain.white_noise->sd_V);
}

TEST(SceneChanges, ADroppedEffectIsNotBuilt) {
  const base::Result<Scene> scene =
      load_scene(kScene, {{{"effects.white_noise", std::nullopt, "--without white_noise"}}, {}});
  ASSERT_TRUE(scene) << scene.error().message;
  for (const std::string_view effect : SceneRun{*scene, 350.0}.effects()) EXPECT_NE(effect, "white_noise");
}

TEST(SceneChanges, TheChangedTextGivesTheSameScene) {
  const base::Result<Scene> scene = load_scene(
      kScene, {{{"paper.mu_s", "0.34", "--set paper.mu_s=0.34"}}, SceneDuration{20.0, "--duration 20"}});
  ASSERT_TRUE(scene) << scene.error().message;
  const base::Result<Scene> again = parse_scene(scene->text, "again.toml");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->mu_s, scene->mu_s);
  EXPECT_EQ(again->duration_s, scene->duration_s);
  EXPECT_EQ(again->oscillator.omega_rad_per_s(), scene->oscillator.omega_rad_per_s());
  EXPECT_EQ(again->white_noise->sd_V, scene->white_noise->sd_V);
}

TEST(SceneChanges, DurationIsThatOfTheWholeSceneAndThePullTakesTheDifference) {
  const Scene plain = *load_scene(kScene);
  const base::Result<Scene> scene = load_scene(kScene, {{}, SceneDuration{60.0, "--duration 60"}});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->duration_s, 60.0);
  EXPECT_EQ(scene->constant_speed->pull_s, 60.0 - plain.duration_s + plain.constant_speed->pull_s);
}

TEST(SceneChanges, DurationOfASceneThatDoesNotPullIsItsOwn) {
  const SceneChanges still{{{"effects.constant_speed", std::nullopt, "--without constant_speed"}},
                           SceneDuration{2.0, "--duration 2"}};
  const base::Result<Scene> scene = load_scene(kScene, still);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->duration_s, 2.0);
}

TEST(SceneChanges, DurationThatLeavesNoPullIsRefused) {
  // idle + stop + return + rest
  EXPECT_EQ(refusal({{}, SceneDuration{3.0, "--duration 3"}}),
            "--duration 3: must be above 3 s, which the scene takes beside the pull");
}

}  // namespace
}  // namespace stickslip::sim
