/// \file
/// A small sweep whose runs differ in every way: regimes, noise, missing scans.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "cli/sweep/grid.hpp"
#include "cli/sweep/runner.hpp"

#include "core/record/sweep.hpp"
#include "core/sim/scene.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::test {

/// Below and above the threshold, three runs each, of a second's pull with scatter and lost scans.
inline sweep::SweepPlan small_plan() {
  sweep::SweepPlan plan;
  plan.repeat = 3;
  for (const char* mu_s : {"0.32", "0.36"}) {
    const auto scene = sim::load_scene(
        std::filesystem::path{STICKSLIP_SOURCE_DIR} / "config/scenes/stick-slip-at-12-in-per-min.toml",
        {{{"effects.scatter.delta_mu_cv", "20 %", "a"},
          {"effects.missing_scans.rate", "1 1/s", "b"},
          {"effects.missing_scans.mean_length", "2", "c"},
          {"paper.mu_s", mu_s, "d"}},
         sim::SceneDuration{4.0, "e"}});
    if (!scene) throw std::runtime_error(scene.error().message);
    plan.points.push_back(*scene);
    plan.seeds.push_back(scene->seed);
  }
  return plan;
}

inline record::SweepFacts small_facts() {
  record::SweepFacts facts;
  facts.version = "1.2.3";
  facts.commit = "abc";
  facts.command = "stickslip sweep test";
  facts.method = "plain";
  facts.scene_name = "test";
  facts.scene_text = "description = \"test\"\n";
  facts.seed = 3;
  facts.axes = {{"paper.mu_s", "1", {0.32, 0.36}, {}}};
  facts.repeat = 3;
  return facts;
}

}  // namespace stickslip::test
