// Detector and estimators on one whole simulated test: time per scan while it runs, and for the
// whole-test fit at its end, beside the raw maximum that the tradition takes.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <vector>

#include "core/analysis/test_analysis.hpp"
#include "core/sim/scene.hpp"
#include "core/sim/scene_run.hpp"

namespace {

using namespace stickslip;

/// Coefficients of one repetition of the shipped sticking scene, 350 Hz, with noise.
std::vector<double> one_test() {
  const auto scene = sim::load_scene(std::filesystem::path{STICKSLIP_SOURCE_DIR} /
                                     "config/scenes/stick-slip-at-12-in-per-min.toml");
  if (!scene) std::abort();
  sim::SceneRun run{*scene, 350.0};
  std::vector<double> all;
  std::array<double, 64> raw{};
  while (const std::size_t count = run.next(raw)) all.insert(all.end(), raw.begin(), raw.begin() + count);
  const double largest = *std::max_element(all.begin(), all.end());
  const double rest = all.front();
  for (double& value : all) value = 0.38 * (value - rest) / (largest - rest);
  return all;
}

void analysis_streaming(benchmark::State& state) {
  const std::vector<double> scans = one_test();
  for (auto _ : state) {
    analysis::TestAnalysis analysis{analysis::AnalysisSettings{}};
    base::ScanIndex index = 0;
    for (const double value : scans) analysis.add(index++, value, false);
    benchmark::DoNotOptimize(analysis);
  }
  state.SetItemsProcessed(state.iterations() * std::ssize(scans));
}
BENCHMARK(analysis_streaming);

void analysis_with_whole_test_fit(benchmark::State& state) {
  const std::vector<double> scans = one_test();
  double cycles = 0.0;
  for (auto _ : state) {
    analysis::TestAnalysis analysis{analysis::AnalysisSettings{}};
    base::ScanIndex index = 0;
    for (const double value : scans) analysis.add(index++, value, false);
    cycles = analysis.finish().cycle_count.value.value_or(0.0);
  }
  state.counters["cycles"] = cycles;
  state.SetItemsProcessed(state.iterations() * std::ssize(scans));
}
BENCHMARK(analysis_with_whole_test_fit);

void peer_raw_maximum(benchmark::State& state) {
  const std::vector<double> scans = one_test();
  for (auto _ : state) benchmark::DoNotOptimize(*std::max_element(scans.begin(), scans.end()));
  state.SetItemsProcessed(state.iterations() * std::ssize(scans));
}
BENCHMARK(peer_raw_maximum);

}  // namespace
