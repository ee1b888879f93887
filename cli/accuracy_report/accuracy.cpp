#include "cli/accuracy_report/accuracy.hpp"

#include <fmt/format.h>

#include <fstream>
#include <stdexcept>
#include <utility>

#include "cli/accuracy_report/scipy_chain.hpp"
#include "cli/simulation/simulate.hpp"

#include "core/daq/calibration.hpp"
#include "core/record/method_text.hpp"
#include "core/sim/motion_solver.hpp"

namespace stickslip::accuracy_report {
namespace {

using base::Result;

// Parts of the progress bar, in proportion to their duration.
constexpr double kMotionShare = 0.5;
constexpr double kGrazingShare = 0.45;

std::string processor() {
  std::ifstream facts{"/proc/cpuinfo"};
  for (std::string line; std::getline(facts, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

/// γ/2ω at which grazing is shown: the scene's if it lies between kLeast and kMost, else kPenner.
double grazing_damping(const model::Oscillator& oscillator) {
  constexpr double kPenner = 0.022;  // [Penner 1995, (19)]
  constexpr double kLeast = 0.005;
  constexpr double kMost = 0.5;
  if (!oscillator.oscillates()) return kPenner;
  const double damping = oscillator.gamma_over_2omega();
  return damping >= kLeast && damping <= kMost ? damping : kPenner;
}

Result<accuracy::ObservedTest> observed(const sim::Scene& scene, std::uint64_t seed,
                                        const base::Clock& clock) {
  Result<simulation::Simulation> simulation = simulation::simulate(scene, seed, clock);
  if (!simulation) return tl::unexpected(simulation.error());
  const record::Record& record = simulation->record;
  const Result<model::Method> method = record::method_from_text(record.header.process.method);
  if (!method) return tl::unexpected(method.error());
  const daq::Calibration calibration{record.header.board, record.header.load_cell.value_or(daq::LoadCell{}),
                                     record.header.tester.tester().normal_load_N()};
  accuracy::ObservedTest test;
  test.settings.scan_rate_Hz = record.header.board.scan_rate_granted_Hz;
  test.settings.step_coefficient = calibration.step_coefficient();
  test.settings.tester = record.header.tester.tester();
  test.settings.method = *method;
  test.scan = record.scan;
  for (const double raw : record.raw) {
    test.coefficient.push_back(calibration.coefficient(raw));
    test.saturated.push_back(calibration.saturated(raw));
  }
  test.truth = *record.end->truth;
  return test;
}

}  // namespace

Result<AccuracyReport> measure_accuracy(const sim::Scene& scene, std::uint64_t seed, const base::Clock& clock,
                                        const accuracy::Progress& progress) {
  AccuracyReport report;
  report.scene_name = scene.name;
  report.scene_description = scene.description;
  report.scan_rate_Hz = sim::true_scan_rate_Hz(scene, scene.scan_rate_Hz);
  const double scans = scene.duration_s * report.scan_rate_Hz;
  if (scans > static_cast<double>(kMostComparedScans)) {
    return base::usage_error(
        "scene {}: {:.4g} scans; at most {} are compared: a shorter --duration or a lower --rate", scene.name,
        scans, kMostComparedScans);
  }
  report.scan_count = sim::scan_count(scene, scene.scan_rate_Hz);
  if (report.scan_count < 1) return base::usage_error("scene {}: lasts 0 s, so it has no scan", scene.name);
  const auto share = [&progress](double from, double part) -> accuracy::Progress {
    if (!progress) return {};
    return [&progress, from, part](double done) { progress(from + part * done); };
  };

  const accuracy::MotionCase motion{sim::motion_of(scene), report.scan_rate_Hz, report.scan_count, seed};
  const std::vector<std::unique_ptr<accuracy::Method>> methods = accuracy::shipped_methods();
  report.asked_accuracy = scene.accuracy;
  report.chosen_method =
      sim::make_motion_solver(motion.motion, motion.scan_rate_Hz, scene.accuracy)->method().name;
  report.processor = processor();
  report.motion = accuracy::compare_motion(motion, methods, clock, share(0.0, kMotionShare));
  report.grazing_gamma_over_2omega = grazing_damping(scene.oscillator);
  report.grazing =
      accuracy::grazing_table(report.grazing_gamma_over_2omega, methods, share(kMotionShare, kGrazingShare));
  const Result<accuracy::ObservedTest> test = observed(scene, seed, clock);
  if (!test) {
    report.no_detection = test.error().message;
  } else {
    report.detection = accuracy::compare_estimators(*test, accuracy::shipped_estimators(), clock);
  }
  report.tiers = accuracy::compare_tiers(clock, {std::string{kScipyChain}, run_scipy_chain});
  if (progress) progress(1.0);
  return report;
}

}  // namespace stickslip::accuracy_report
