// What each effect of a scene costs: the sticking scene with nothing but its motion, and with one effect
// more. items_per_second are scans; the marginal cost of an effect is its row's time for a scan less that of
// "motion". The row "with_force" asks for the noise-free force too, as records have it.

#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/sim/scene.hpp"
#include "core/sim/scene_run.hpp"

namespace {

using namespace stickslip::sim;
using stickslip::model::Oscillator;

using Change = std::function<void(Scene&)>;

/// As the shipped scenes set them.
const std::vector<std::pair<std::string, Change>>& effects() {
  static const std::vector<std::pair<std::string, Change>> kEffects{
      {"motion", [](Scene&) {}},
      // Motion stage, one line each. The scene has damping and one-way coupling: they cost
      // "motion" less the row without.
      {"without_damping",
       [](Scene& scene) {
         scene.damping = false;
         scene.oscillator = Oscillator::from_omega(scene.oscillator.omega_rad_per_s(), 0.0);
       }},
      {"without_one_way_coupling", [](Scene& scene) { scene.one_way_coupling = false; }},
      {"scatter",
       [](Scene& scene) {
         scene.paper.scatter = Scatter{0.35, 0.004, 0.001};
       }},
      {"first_peak",
       [](Scene& scene) {
         scene.paper.first_peak = FirstPeak{0.06, 0.005};
       }},
      {"contact_ageing",
       [](Scene& scene) {
         scene.paper.contact_ageing = ContactAgeing{0.02, 0.001};
       }},
      {"onset_convention", [](Scene& scene) { scene.onset_convention = OnsetConvention::kSpringAndDamper; }},
      {"speed_ramp", [](Scene& scene) { scene.speed_ramp = SpeedRamp{0.009}; }},
      {"exponential_start", [](Scene& scene) { scene.exponential_start = ExponentialStart{0.2}; }},
      {"jerk_limited_start", [](Scene& scene) { scene.jerk_limited_start = JerkLimitedStart{0.05}; }},
      {"piecewise_speed",
       [](Scene& scene) {
         scene.constant_speed.reset();
         scene.piecewise_speed = PiecewiseSpeed{{{0.5, 0.0}, {0.5, 0.00508}, {5.5, 0.00508}}};
       }},
      {"startup_slack", [](Scene& scene) { scene.startup_slack_m = 0.001; }},
      {"kinetic_drift",
       [](Scene& scene) {
         scene.kinetic_drift =
             KineticDrift{KineticDrift::Form::kLinear, KineticDrift::Over::kTime, -0.1, 8.0};
       }},
      // Solved numerically, to the scene's accuracy of 1e-9: the price is that of CVODE, not of the law.
      {"velocity_dependence", [](Scene& scene) { scene.velocity_dependence_s_per_m = -0.5; }},
      {"stribeck",
       [](Scene& scene) {
         scene.stribeck = Stribeck{0.02, 0.001, 2.0};
       }},
      {"rate_and_state",
       [](Scene& scene) {
         scene.rate_and_state = RateAndState{RateAndState::Law::kAgeing, 0.01, 0.02, 1e-5, 1e-6, 0.30};
       }},
      // Transducer, sampling and signal stage.
      {"load_cell",
       [](Scene& scene) {
         scene.load_cell_dynamics = stickslip::model::LoadCellDynamics{300.0, 0.02};
       }},
      {"anti_alias",
       [](Scene& scene) {
         scene.anti_alias = stickslip::model::AntiAlias{100.0, 4};
       }},
      {"clock_rate_error", [](Scene& scene) { scene.clock_rate_error = ClockRateError{2e-4}; }},
      {"clock_jitter", [](Scene& scene) { scene.clock_jitter = ClockJitter{5e-5}; }},
      {"missing_scans",
       [](Scene& scene) {
         scene.missing_scans = MissingScans{0.5, 4.0};
       }},
      {"white_noise", [](Scene& scene) { scene.white_noise = WhiteNoise{0.01}; }},
      {"drift_noise",
       [](Scene& scene) {
         scene.drift_noise = DriftNoise{0.02, 0.001, 175.0};
       }},
      {"mains_hum",
       [](Scene& scene) {
         scene.mains_hum = MainsHum{60.0, 0.02, {{1, 1.0, 0.0}, {2, 0.3, 0.0}, {3, 0.1, 0.0}}};
       }},
      {"spikes",
       [](Scene& scene) {
         scene.spikes = Spikes{1.0, 1.0, Spikes::Sizes::kExponential};
       }},
      {"quantisation", [](Scene& scene) { scene.quantisation = Quantisation{}; }}};
  return kEffects;
}

/// The base of all rows.
Scene sticking_scene() {
  auto loaded = load_scene(std::filesystem::path(STICKSLIP_SOURCE_DIR) / "config" / "scenes" /
                           "stick-slip-at-12-in-per-min.toml");
  if (!loaded) throw std::runtime_error(loaded.error().message);
  loaded->white_noise.reset();
  loaded->quantisation.reset();
  return *loaded;
}

void effect(benchmark::State& state, const Change& change) {
  Scene scene = sticking_scene();
  change(scene);
  SceneRun run{scene, scene.scan_rate_Hz};
  std::array<double, 64> raw{};
  std::int64_t scans = 0;
  for (auto _ : state) {
    run.restart(1);
    while (run.next(raw) > 0) benchmark::DoNotOptimize(raw);
    scans += run.next_scan();
  }
  state.SetItemsProcessed(scans);
}

void with_force(benchmark::State& state) {
  const Scene scene = sticking_scene();
  SceneRun run{scene, scene.scan_rate_Hz};
  std::array<double, 64> raw{};
  std::array<double, 64> force{};
  std::int64_t scans = 0;
  for (auto _ : state) {
    run.restart(1);
    while (run.next(raw, force) > 0) benchmark::DoNotOptimize(force);
    scans += run.next_scan();
  }
  state.SetItemsProcessed(scans);
}
BENCHMARK(with_force)->Name("effect/with_force");

const bool kRegistered = [] {
  for (const auto& [name, change] : effects()) {
    benchmark::RegisterBenchmark(("effect/" + name).c_str(), effect, change);
  }
  return true;
}();

}  // namespace
