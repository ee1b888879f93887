#include "daemon/sweep/run.hpp"

#include <array>
#include <utility>

#include "core/daq/calibration.hpp"
#include "core/friction/test_analysis.hpp"
#include "core/sim/scene_run.hpp"
#include "core/sim/scene_truth.hpp"
#include "daemon/simulate.hpp"
#include "drivers/simulated/scene_facts.hpp"

namespace stickslip::daemon {
namespace {

friction::TestResults results_of(const sim::Scene& scene, std::uint64_t seed) {
  const friction::Tester tester = drivers::tester_of({scene});
  const daq::Calibration calibration{drivers::board_info_of({scene}, scene.scan_rate_Hz),
                                     drivers::load_cell_of(scene), tester.normal_load_N()};
  friction::AnalysisSettings settings;
  settings.scan_rate_Hz = scene.scan_rate_Hz;
  settings.step_coefficient = calibration.step_coefficient();
  settings.tester = tester;
  friction::TestAnalysis analysis{settings};

  sim::SceneRun run{scene, scene.scan_rate_Hz};
  run.restart(seed);
  std::array<double, 1024> raw{};
  std::int64_t expected = -1;  // Nothing is missing before the first scan that arrives.
  for (;;) {
    std::int64_t scan = run.next_scan();
    const std::size_t arrived = run.next(raw);
    if (arrived == 0) break;
    if (expected >= 0 && scan != expected) analysis.gap(expected, scan - expected);
    for (std::size_t i = 0; i < arrived; ++i) {
      analysis.add(scan++, calibration.coefficient(raw[i]), calibration.saturated(raw[i]));
    }
    expected = scan;
  }
  if (expected < 0) return record::absent_results("all scans are missing");
  return analysis.finish();
}

}  // namespace

base::Result<void> check_runnable(const sim::Scene& scene) {
  const double scan_count = scene.duration_s * scene.scan_rate_Hz;
  if (scan_count > static_cast<double>(kMostSimulatedScans)) {
    return base::usage_error(
        "scene {}: {:.4g} scans; one run may have {}: a shorter --duration or a lower --rate", scene.name,
        scan_count, kMostSimulatedScans);
  }
  if (sim::scan_count(scene, scene.scan_rate_Hz) < 1) {
    return base::usage_error("scene {}: lasts 0 s, so it has no scan", scene.name);
  }
  return {};
}

record::SweepRun sweep_run(const sim::Scene& scene, std::uint64_t seed, std::int64_t number) {
  record::SweepRun run;
  run.number = number;
  run.results = results_of(scene, seed);
  run.truth = sim::scene_truth(scene, scene.scan_rate_Hz, seed);
  run.true_cycle_count = static_cast<std::int64_t>(run.truth.cycles.size());
  run.truth.cycles.clear();
  run.truth.modes.clear();
  run.truth.scene_text.clear();
  return run;
}

}  // namespace stickslip::daemon
