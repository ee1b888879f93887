#include "cli/sweep/run.hpp"

#include <optional>

#include "cli/simulation/simulate.hpp"
#include "cli/sweep/scene_scans.hpp"

#include "core/analysis/test_analysis.hpp"
#include "core/sim/scene_truth.hpp"
#include "drivers/simulated/simulated_truth.hpp"

namespace stickslip::sweep {
namespace {

/// \param arrived  receives the first scan that arrives, if any does.
analysis::TestResults results_of(const sim::Scene& scene, std::uint64_t seed, detect::EstimatorTier estimator,
                                 std::optional<base::ScanIndex>& arrived) {
  const daq::Calibration calibration = calibration_of(scene);
  analysis::AnalysisSettings settings;
  settings.scan_rate_Hz = scene.scan_rate_Hz;
  settings.step_coefficient = calibration.step_coefficient();
  settings.tester = drivers::tester_of({scene});
  settings.estimator = estimator;
  analysis::TestAnalysis analysis{settings};
  const bool any = play(
      scene, seed, calibration,
      [&](base::ScanIndex scan, double coefficient, bool saturated) {
        if (!arrived) arrived = scan;
        analysis.add(scan, coefficient, saturated);
      },
      [&](base::ScanIndex first, std::int64_t count) { analysis.gap(first, count); });
  if (!any) return record::absent_results("all scans are missing");
  return analysis.finish();
}

}  // namespace

base::Result<void> check_runnable(const sim::Scene& scene) {
  const double scan_count = scene.duration_s * scene.scan_rate_Hz;
  if (scan_count > static_cast<double>(simulation::kMostSimulatedScans)) {
    return base::usage_error(
        "scene {}: {:.4g} scans; one run may have {}: a shorter --duration or a lower --rate", scene.name,
        scan_count, simulation::kMostSimulatedScans);
  }
  if (sim::scan_count(scene, scene.scan_rate_Hz) < 1) {
    return base::usage_error("scene {}: lasts 0 s, so it has no scan", scene.name);
  }
  return {};
}

record::SweepRun sweep_run(const sim::Scene& scene, std::uint64_t seed, std::int64_t number,
                           detect::EstimatorTier estimator) {
  record::SweepRun run;
  run.number = number;
  std::optional<base::ScanIndex> arrived;
  run.results = results_of(scene, seed, estimator, arrived);
  run.truth = sim::scene_truth(scene, scene.scan_rate_Hz, seed);
  // As simulate: a record begins with the first scan that arrived.
  drivers::move_into_window(run.truth, static_cast<double>(arrived.value_or(0)) / scene.scan_rate_Hz,
                            scene.duration_s);
  run.true_cycle_count = static_cast<std::int64_t>(run.truth.cycles.size());
  run.truth.cycles.clear();
  run.truth.modes.clear();
  run.truth.scene_text.clear();
  return run;
}

}  // namespace stickslip::sweep
