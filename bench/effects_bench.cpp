// What each effect of a scene costs: the sticking scene with nothing but its motion, and with one effect
// more. items_per_second are scans; the marginal cost of an effect is its row's time for a scan less that of
// "motion".

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

using Change = std::function<void(Scene&)>;

/// As the shipped scenes set them.
const std::vector<std::pair<std::string, Change>>& effects() {
  static const std::vector<std::pair<std::string, Change>> kEffects{
      {"motion", [](Scene&) {}},
      {"load_cell",
       [](Scene& scene) {
         scene.load_cell_dynamics = LoadCellDynamics{300.0, 0.02};
       }},
      {"anti_alias",
       [](Scene& scene) {
         scene.anti_alias = AntiAlias{100.0, 4};
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

void effect(benchmark::State& state, const Change& change) {
  auto loaded = load_scene(std::filesystem::path(STICKSLIP_SOURCE_DIR) / "config" / "scenes" /
                           "stick-slip-at-12-in-per-min.toml");
  if (!loaded) throw std::runtime_error(loaded.error().message);
  loaded->white_noise.reset();
  loaded->quantisation.reset();
  change(*loaded);
  SceneRun run{*loaded, loaded->scan_rate_Hz};
  std::array<double, 64> raw{};
  std::int64_t scans = 0;
  for (auto _ : state) {
    run.restart(1);
    while (run.next(raw) > 0) benchmark::DoNotOptimize(raw);
    scans += run.next_scan();
  }
  state.SetItemsProcessed(scans);
}

const bool kRegistered = [] {
  for (const auto& [name, change] : effects()) {
    benchmark::RegisterBenchmark(("effect/" + name).c_str(), effect, change);
  }
  return true;
}();

}  // namespace
