// How soon the live detector declares an escape, and how often it takes a captured slip for one, with the
// tester characterised: the tables of docs/detector-limits.md.
//
//     live_limits [SLIPS [ESCAPES]]     of each row; 10000 and 2000 unless told

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bench/arguments.hpp"
#include "core/model/threshold.hpp"
#include "tests/support/live_trials.hpp"

namespace {

using namespace stickslip;

detect::LiveSettings settings_of(const test::LiveScene& scene) {
  detect::LiveSettings settings;
  settings.scan_rate_Hz = scene.scan_rate_Hz;
  settings.prior = scene.characterised();
  return settings;
}

void false_escapes(const char* what, test::LiveScene scene, int slips) {
  scene.slips = 21;
  int captured = 0;
  int wrong = 0;
  for (scene.seed = 1; captured < slips; ++scene.seed) {
    const test::LiveOutcome outcome = run_live(scene, settings_of(scene));
    wrong += outcome.false_escapes;
    captured += scene.slips - 1;
  }
  fmt::print("| {} | {} | {} |\n", what, captured, wrong);
}

void escapes(double over_threshold, int count) {
  test::LiveScene scene;
  scene.slips = 1;
  scene.escape_Q = over_threshold * model::Q_threshold(scene.gamma_over_2omega);
  int soon = 0;
  int later = 0;
  double worst = 0.0;
  for (scene.seed = 1; scene.seed <= static_cast<std::uint64_t>(count); ++scene.seed) {
    const test::LiveOutcome outcome = run_live(scene, settings_of(scene));
    const double onset_s = test::LiveTrial{scene}.slips().back().onset_s;
    const double periods = (outcome.escape_declared_s - onset_s) * scene.frequency_Hz;
    soon += periods <= 1.5 ? 1 : 0;
    later += periods <= 3.0 ? 1 : 0;
    worst = std::max(worst, std::isnan(periods) ? scene.escape_periods : periods);
  }
  fmt::print("| {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", over_threshold, 100.0 * soon / count,
             100.0 * later / count, worst);
}

}  // namespace

int main(int argc, char** argv) {
  const int slips = test::argument(argc, argv, 1, 10'000);
  const int count = test::argument(argc, argv, 2, 2'000);
  fmt::print(
      "350 scans/s, 20 Hz, noise 0.02 (S − K), seeds from 1\n\n| captured slips | of | taken for an escape "
      "|\n"
      "|---|---|---|\n");
  test::LiveScene scene;
  false_escapes("12 in/min, Q/Q_th 0.68", scene, slips);
  scene.Q = 0.654;
  false_escapes("6 in/min, 0.34", scene, slips);
  scene.Q = 1.7;
  false_escapes("0.88", scene, slips);
  scene.Q = 1.0;
  scene.scatter = 0.1;
  false_escapes("0.52, S − K scattered by 10 %", scene, slips);
  fmt::print(
      "\n| Q/Q_th of the escape | within 1.5 periods, % | within 3, % | last, periods "
      "|\n|---|---|---|---|\n");
  for (const double over : {1.05, 1.13, 1.35, 1.55, 2.0}) escapes(over, count);
  return 0;
}
