/// \file
/// Scenes drawn at random over all shipped friction laws and effects.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <random>
#include <vector>

#include "core/base/result.hpp"
#include "core/sim/random_stream.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::test {

/// Shipped scenes with one pull, by name. Errors: those of load_scene(). \param folder  config/scenes.
inline base::Result<std::vector<sim::Scene>> scenes_with_one_pull(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator{folder}) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<sim::Scene> scenes;
  for (const auto& file : files) {
    auto scene = sim::load_scene(file);
    if (!scene) return tl::unexpected(scene.error());
    if (scene->constant_speed) scenes.push_back(*std::move(scene));
  }
  return scenes;
}

/// One of the scenes with another seed, at 0.5 to 2 times its speed, each further effect in one of five:
/// slope of friction with speed, scatter, load cell, filter, hum, wandering level, spikes, missing scans,
/// jitter, coarse converter.
inline sim::Scene random_scene(const std::vector<sim::Scene>& bases, std::uint64_t seed) {
  std::mt19937_64 random{sim::stream_seed(seed, "random_scene")};
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>{low, high}(random);
  };
  const auto is_chosen = [&] { return uniform(0.0, 1.0) < 0.2; };
  sim::Scene scene = bases[std::uniform_int_distribution<std::size_t>{0, bases.size() - 1}(random)];
  scene.seed = seed;
  // Of one motion: a ramp's other end goes with it.
  const double faster = std::exp2(uniform(-1.0, 1.0));
  scene.constant_speed->pull_speed_m_per_s *= faster;
  if (scene.speed_ramp) scene.speed_ramp->to_m_per_s *= faster;
  const double V = (scene.mu_s - scene.mu_k) * scene.normal_load_N() / scene.load_cell.gain_N_per_V;
  const bool has_own_law = scene.rate_and_state || scene.stribeck || scene.velocity_dependence_s_per_m;
  const bool is_sloped = is_chosen() && !has_own_law;
  if (is_sloped) scene.velocity_dependence_s_per_m = uniform(-0.4, 0.4);
  if (is_chosen() && !scene.rate_and_state)
    scene.paper.scatter = sim::Scatter{.delta_mu_cv = uniform(0.0, 0.3)};
  if (is_chosen()) scene.load_cell_dynamics = model::LoadCellDynamics{uniform(60.0, 300.0), 0.05};
  if (is_chosen())
    scene.anti_alias = model::AntiAlias{uniform(40.0, 170.0), std::uniform_int_distribution{1, 4}(random)};
  if (is_chosen()) scene.mains_hum = sim::MainsHum{50.0, uniform(0.01, 0.2) * V, {{}}};
  if (is_chosen()) scene.drift_noise = sim::DriftNoise{uniform(0.01, 0.2) * V, 0.05, 5.0};
  if (is_chosen()) scene.spikes = sim::Spikes{uniform(0.2, 20.0), uniform(0.2, 2.0) * V};
  if (is_chosen()) scene.missing_scans = sim::MissingScans{uniform(0.1, 2.0), uniform(1.0, 50.0)};
  if (is_chosen()) scene.clock_jitter = sim::ClockJitter{uniform(0.0, 0.2) / scene.scan_rate_Hz};
  if (is_chosen() && scene.quantisation) scene.quantisation->bits = 9;
  return scene;
}

}  // namespace stickslip::test
