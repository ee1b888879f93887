#include "daemon/sweep/run.hpp"

#include "core/friction/test_analysis.hpp"
#include "core/sim/scene_truth.hpp"
#include "daemon/simulate.hpp"
#include "daemon/sweep/scene_scans.hpp"

namespace stickslip::daemon {
namespace {

friction::TestResults results_of(const sim::Scene& scene, std::uint64_t seed,
                                 friction::EstimatorTier estimator) {
  const daq::Calibration calibration = calibration_of(scene);
  friction::AnalysisSettings settings;
  settings.scan_rate_Hz = scene.scan_rate_Hz;
  settings.step_coefficient = calibration.step_coefficient();
  settings.tester = drivers::tester_of({scene});
  settings.estimator = estimator;
  friction::TestAnalysis analysis{settings};
  const bool any = play(
      scene, seed, calibration,
      [&](base::ScanIndex scan, double coefficient, bool saturated) {
        analysis.add(scan, coefficient, saturated);
      },
      [&](base::ScanIndex first, std::int64_t count) { analysis.gap(first, count); });
  if (!any) return record::absent_results("all scans are missing");
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

record::SweepRun sweep_run(const sim::Scene& scene, std::uint64_t seed, std::int64_t number,
                           friction::EstimatorTier estimator) {
  record::SweepRun run;
  run.number = number;
  run.results = results_of(scene, seed, estimator);
  run.truth = sim::scene_truth(scene, scene.scan_rate_Hz, seed);
  run.true_cycle_count = static_cast<std::int64_t>(run.truth.cycles.size());
  run.truth.cycles.clear();
  run.truth.modes.clear();
  run.truth.scene_text.clear();
  return run;
}

}  // namespace stickslip::daemon
