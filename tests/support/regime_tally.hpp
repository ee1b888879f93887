/// \file
/// How often the detector's word for a random test is the true one.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <thread>
#include <vector>

#include "cli/sweep/runner.hpp"

#include "core/analysis/results.hpp"
#include "core/base/result.hpp"
#include "core/model/regime.hpp"
#include "core/sim/scene.hpp"
#include "core/sim/scene_truth.hpp"
#include "tests/support/random_tests.hpp"

namespace stickslip::test {

struct RegimeTally {
  int tests = 0;
  int wrong = 0;
  int undecided = 0;

  void add(model::Regime truth, model::Regime measured) noexcept {
    ++tests;
    if (measured == model::Regime::kUndecided) {
      ++undecided;
    } else if (measured != truth) {
      ++wrong;
    }
  }
};

/// transition_time of the mixed tests that were called so, against the onset of the slip that escaped.
struct TransitionTally {
  int tests = 0;
  int other_slip = 0;  ///< Off by more than a quarter of an oscillation, and in no sum below.
  double square_sum_s2 = 0.0;
  double normalised_square_sum = 0.0;  ///< Of errors over standard errors.

  void add(double truth_s, const analysis::Estimate& found, double oscillation_s) noexcept {
    ++tests;
    const double error_s = found.value.value_or(std::numeric_limits<double>::infinity()) - truth_s;
    if (!(std::abs(error_s) < 0.25 * oscillation_s) || !found.standard_error) {
      ++other_slip;
      return;
    }
    square_sum_s2 += error_s * error_s;
    normalised_square_sum += std::pow(error_s / *found.standard_error, 2);
  }
  [[nodiscard]] int told() const noexcept { return tests - other_slip; }
  [[nodiscard]] double rms_s() const noexcept { return std::sqrt(square_sum_s2 / told()); }
  /// Of errors over standard errors; 1 if these are right.
  [[nodiscard]] double variance() const noexcept { return normalised_square_sum / told(); }
};

struct RegimeTable {
  std::map<model::Regime, RegimeTally> of_regime;  ///< By what the simulation really did.
  RegimeTally few_captures;                        ///< Tests with one to three captures.
  TransitionTally transitions;
};

/// Random tests 0 … count − 1 of this seed, on all processors; the same table for any number of them.
inline base::Result<RegimeTable> judge_random_tests(
    const sim::Scene& base, const Disturbance& disturbance, std::int64_t count, std::uint64_t seed,
    detect::EstimatorTier estimator = detect::EstimatorTier::kFit) {
  sweep::SweepPlan plan;
  plan.estimator = estimator;
  for (std::int64_t i = 0; i < count; ++i) {
    const std::uint64_t own = sim::stream_seed(seed, static_cast<std::uint64_t>(i));
    plan.points.push_back(random_test(base, disturbance, own));
    plan.seeds.push_back(own);
  }
  std::vector<std::int64_t> numbers(static_cast<std::size_t>(count));
  std::iota(numbers.begin(), numbers.end(), 0);
  RegimeTable table;
  const std::atomic<bool> stop{false};
  const auto take = [&](const record::SweepRun& run) -> base::Result<void> {
    const sim::Scene& scene = plan.points[static_cast<std::size_t>(run.number)];
    const model::TestTruth truth = sim::scene_truth(scene, scene.scan_rate_Hz, plan.seed_of(run.number));
    const sim::Pull pull = *sim::pull_of(scene);
    const int captured = captures(truth, pull);
    table.of_regime[truth.regime].add(truth.regime, run.results.regime);
    if (captured >= 1 && captured <= 3) table.few_captures.add(truth.regime, run.results.regime);
    if (truth.regime == model::Regime::kMixed && run.results.regime == model::Regime::kMixed) {
      table.transitions.add(escape_onset_s(truth, pull).value(), run.results.transition_time,
                            2.0 * std::numbers::pi / truth.omega_rad_per_s);
    }
    return {};
  };
  const auto threads = static_cast<std::int64_t>(std::max(std::thread::hardware_concurrency(), 1U));
  if (auto done = sweep::do_runs(plan, numbers, threads, stop, take); !done) {
    return tl::unexpected(done.error());
  }
  return table;
}

}  // namespace stickslip::test
