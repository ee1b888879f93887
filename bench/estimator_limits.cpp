// How close the estimators come to the Cramér–Rao bound, by simulation through the whole analysis:
//
//     estimator_limits [SEEDS [FIRST]]      # 4000 seeds from 1 on
//
// The table of docs/detector-limits.md.

#include "tests/support/estimator_limits.hpp"

#include <fmt/format.h>

#include <chrono>

#include "bench/arguments.hpp"

int main(int argc, char** argv) {
  using namespace stickslip;
  const int seeds = test::argument(argc, argv, 1, 4000);
  const int first = test::argument(argc, argv, 2, 1);
  const test::LimitScene scene;
  fmt::print(
      "{} seeds ({} to {}) a case; S 0.35, K 0.30, 12 in/min, 350 Hz, 0.001 rms white, {} cycles after the "
      "first\n",
      seeds, first, first + seeds - 1, test::LimitScene::kCycles);
  fmt::print("tester from one ring-down of {} s: gamma {:.2f} %\n", test::LimitScene::kRingDown_s,
             100.0 * std::sqrt(scene.coupling_covariance()(1, 1)) / 0.022);
  fmt::print(
      "bounds: S - K with gamma/2omega alone from the tester and the speed {:.3f} %; pull speed with the "
      "tester {:.3f} %\n",
      100.0 * scene.delta_mu_bound_with_gamma_alone() / 0.05, 100.0 * scene.pull_speed_bound());
  fmt::print("{:<48}{:<14}{:>10}{:>11}{:>10}{:>10}{:>10}\n", "known beforehand", "result", "bound, %",
             "rms/bound", "z mean", "z var.", "in 95 %");
  for (const test::LimitCase& which : test::kLimitCases) {
    const auto begin = std::chrono::steady_clock::now();
    const test::LimitReport report = scene.run(which, seeds, first);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    for (const test::LimitTally& tally : report.tallies) {
      fmt::print("{:<48}{:<14}{:>10.4f}{:>11.3f}{:>10.3f}{:>10.3f}{:>9.1f} %\n", which.name(), tally.what,
                 100.0 * tally.bound / tally.truth, tally.rms_over_bound(), tally.normalised_mean(),
                 tally.normalised_variance(), 100.0 * tally.coverage());
    }
    fmt::print("    without a result: {}; {:.0f} µs a cycle for the whole analysis\n", report.without_result,
               1e6 * seconds / seeds / (test::LimitScene::kCycles + 1));
  }
  return 0;
}
