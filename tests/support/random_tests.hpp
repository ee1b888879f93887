/// \file
/// Tests of papers drawn at random, with what the detector says of them beside what the simulation did.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <random>
#include <stdexcept>

#include "core/model/regime.hpp"
#include "core/model/threshold.hpp"
#include "core/model/truth.hpp"
#include "core/sim/random_stream.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::test {

/// What disturbs the tests, as a part of S − K.
struct Disturbance {
  double noise = 0.02;         ///< White, standard deviation of a scan.
  double drift_per_s = 0.02;   ///< Fall of K (and S with it), as a coefficient.
  double spikes_per_s = 20.0;  ///< Single scans, exponential sizes.
  double spike_size = 1.0;     ///< Mean.
};

/// A 5 s pull of a paper with S − K 0.02 to 0.1, its scatter 0 to 30 %, at Q/Q_th 0.3 to 3, all uniform.
/// \param base  a scene with constant speed, damping, one-way coupling, white noise and converter.
inline sim::Scene random_test(const sim::Scene& base, const Disturbance& disturbance, std::uint64_t seed) {
  std::mt19937_64 random{sim::stream_seed(seed, "random_test")};
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>{low, high}(random);
  };
  sim::Scene scene = base;
  scene.seed = seed;
  const double delta_mu = uniform(0.02, 0.1);
  scene.mu_s = scene.mu_k + delta_mu;
  scene.constant_speed->pull_speed_m_per_s =
      uniform(0.3, 3.0) * model::threshold_speed_m_per_s(scene.oscillator, delta_mu, scene.gravity_m_per_s2);
  scene.paper.scatter = sim::Scatter{.delta_mu_cv = uniform(0.0, 0.3)};
  const double V_per_coefficient = scene.normal_load_N() / scene.load_cell.gain_N_per_V;
  scene.white_noise = sim::WhiteNoise{disturbance.noise * delta_mu * V_per_coefficient};
  if (disturbance.spikes_per_s > 0.0) {
    scene.spikes =
        sim::Spikes{disturbance.spikes_per_s, disturbance.spike_size * delta_mu * V_per_coefficient};
  }
  if (disturbance.drift_per_s != 0.0) {
    scene.kinetic_drift = sim::KineticDrift{
        .change = -disturbance.drift_per_s * scene.duration_s / scene.mu_k, .scale = scene.duration_s};
  }
  return scene;
}

/// Calls visit(onset in s, whether it ended in sticking within the pull) for each slip that began by giving
/// way.
template <typename Visitor>
void for_each_slip(const model::TestTruth& truth, const sim::Pull& pull, const Visitor& visit) {
  auto mode = truth.modes.begin();
  for (const model::TrueCycle& cycle : truth.cycles) {
    mode = std::find_if(mode, truth.modes.end(), [&](const model::ModeInterval& interval) {
      return interval.mode == model::Mode::kSlip && interval.start_s >= cycle.onset_time_s;
    });
    if (mode != truth.modes.end()) visit(cycle.onset_time_s, (*mode).end_s < pull.end_s);
  }
}

/// Slips of the pull that began by giving way and ended in sticking.
inline int captures(const model::TestTruth& truth, const sim::Pull& pull) {
  int count = 0;
  for_each_slip(truth, pull, [&](double /*onset_s*/, bool captured) { count += captured ? 1 : 0; });
  return count;
}

/// Onset of the first slip that did not end in sticking, s; nothing if each did.
inline std::optional<double> escape_onset_s(const model::TestTruth& truth, const sim::Pull& pull) {
  std::optional<double> onset;
  for_each_slip(truth, pull, [&](double onset_s, bool captured) {
    if (!captured && !onset) onset = onset_s;
  });
  return onset;
}

}  // namespace stickslip::test
