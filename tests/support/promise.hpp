/// \file
/// "This would improve the precision by about a factor of 5 or so" [Penner 1995, Discussion]: how much more
/// reproducible S − K of all cycles is than the first peak less the mean, by simulated tests.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <thread>
#include <vector>

#include "cli/sweep/runner.hpp"

#include "core/base/result.hpp"
#include "core/model/closed_forms.hpp"
#include "core/model/threshold.hpp"
#include "core/sim/random_stream.hpp"
#include "core/sim/scene.hpp"
#include "tests/support/random_tests.hpp"

namespace stickslip::test {

/// The conditions of one comparison.
struct PromiseCell {
  int cycles = 10;             ///< That the pull lasts, if all slips were like the mean.
  double scatter = 0.1;        ///< Standard deviation of S − K over its mean, log-normal.
  double first_peak_sd = 0.0;  ///< Of what the first S differs by, from test to test, as a coefficient.
  double speed_ratio = 0.2;    ///< Q/Q_th of the mean S − K.
  double drift_per_s = 0.02;   ///< Fall of K and S, as a coefficient.
  double spikes_per_s = 20.0;  ///< Single scans, exponential sizes with the mean S − K.
  static constexpr double kDeltaMu = 0.05;  ///< Mean [Penner 1995, Table 1].
};

/// \param base  a scene with constant speed, damping, one-way coupling, white noise and converter.
inline sim::Scene promise_scene(const sim::Scene& base, const PromiseCell& cell) {
  constexpr double kDeltaMu = PromiseCell::kDeltaMu;
  sim::Scene scene = base;
  sim::ConstantSpeed& belt = *scene.constant_speed;
  belt.pull_speed_m_per_s =
      cell.speed_ratio * model::threshold_speed_m_per_s(scene.oscillator, kDeltaMu, scene.gravity_m_per_s2);
  const double omega = scene.oscillator.omega_rad_per_s();
  const double r = scene.oscillator.stick_rate_per_s(belt.pull_speed_m_per_s, scene.gravity_m_per_s2);
  const double Q = model::dimensionless_speed(r, omega, kDeltaMu);
  const double cycle_s = (model::undamped_stick_phase_rad(Q) + model::undamped_slip_phase_rad(Q)) / omega;
  // K ends at the base's, so that no drift brings it near zero.
  const double cycles_s = (cell.cycles + 0.5) * cycle_s;
  const double idle_s = belt.idle_s;
  const double end_mu_k = scene.mu_k;
  // Loading takes S/r, and K falls meanwhile.
  scene.mu_k =
      (end_mu_k + cell.drift_per_s * (idle_s + cycles_s + kDeltaMu / r)) / (1.0 - cell.drift_per_s / r);
  scene.mu_s = scene.mu_k + kDeltaMu;
  belt.pull_s = cycles_s + scene.mu_s / r;
  scene.duration_s = belt.duration_s();
  scene.paper.scatter = sim::Scatter{.delta_mu_cv = cell.scatter};
  if (cell.first_peak_sd > 0.0) scene.paper.first_peak = sim::FirstPeak{.sd = cell.first_peak_sd};
  scene.kinetic_drift = sim::KineticDrift{.change = -cell.drift_per_s / scene.mu_k, .scale = 1.0};
  scene.load_cell.gain_N_per_V = 4.0;  // Half the converter's range for the highest K.
  const double V_per_coefficient = scene.normal_load_N() / scene.load_cell.gain_N_per_V;
  scene.white_noise = sim::WhiteNoise{0.02 * kDeltaMu * V_per_coefficient};
  scene.spikes = sim::Spikes{cell.spikes_per_s, kDeltaMu * V_per_coefficient};
  return scene;
}

/// One number of many tests.
struct PromiseSample {
  std::vector<double> values;
  int missing = 0;

  void add(std::optional<double> value) {
    if (value) {
      values.push_back(*value);
    } else {
      ++missing;
    }
  }
  [[nodiscard]] double mean() const {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  }
  /// Standard deviation of a test over the mean. At least two values.
  [[nodiscard]] double relative_error() const { return relative_error_without(values.size()); }
  /// The same without value i; i = size(): with all.
  [[nodiscard]] double relative_error_without(std::size_t i) const {
    const double n = static_cast<double>(values.size()) - (i < values.size() ? 1.0 : 0.0);
    const double own_mean =
        (mean() * static_cast<double>(values.size()) - (i < values.size() ? values[i] : 0.0)) / n;
    double squares = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (k != i) squares += (values[k] - own_mean) * (values[k] - own_mean);
    }
    return std::sqrt(squares / (n - 1.0)) / own_mean;
  }
  /// Variance of ln relative_error() by leaving out one test after the other [Efron, The Jackknife, 1982, ch.
  /// 3].
  [[nodiscard]] double log_error_variance() const {
    const auto n = static_cast<double>(values.size());
    double sum = 0.0;
    double square_sum = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double without = std::log(relative_error_without(i) / relative_error());
      sum += without;
      square_sum += without * without;
    }
    return (n - 1.0) / n * (square_sum - sum * sum / n);
  }
};

/// Both numbers of the same tests.
struct PromisePair {
  PromiseSample traditional;  ///< Static less kinetic coefficient of method penner-1995.
  PromiseSample delta_mu;     ///< S − K.

  [[nodiscard]] std::size_t tests() const noexcept {
    return traditional.values.size() + static_cast<std::size_t>(traditional.missing);
  }
  /// Relative standard error of the one over that of the other.
  [[nodiscard]] double factor() const { return traditional.relative_error() / delta_mu.relative_error(); }
  /// As if the two were independent: with the first slip left out of S − K they nearly are.
  [[nodiscard]] double factor_standard_error() const {
    return factor() * std::sqrt(traditional.log_error_variance() + delta_mu.log_error_variance());
  }
};

struct PromiseResult {
  PromisePair all;
  /// Tests that the analysis calls stick-slip or mixed: where no slip ends in sticking the first is all there
  /// is, so that S − K is as unrepresentative as the first peak.
  PromisePair stuck;
  std::vector<double> stated;  ///< Standard errors of S − K as the results state them; of stuck.
  double cycle_count = 0.0;    ///< Mean of the slips found, all tests.
};

/// Relative standard error that the conditions alone give the first peak less the mean: S − K of one slip and
/// what the first adds. The peak is K + √(D² + (r/ω)²) [2], so that its slope is 1/√(1 + Q²); what the mean
/// of ten cycles scatters is left out.
inline double expected_traditional_error(const PromiseCell& cell, double Q) {
  const double ratio = cell.first_peak_sd / PromiseCell::kDeltaMu;
  return std::sqrt(cell.scatter * cell.scatter + ratio * ratio) / (1.0 + Q * Q);
}

/// Q of the mean S − K.
inline double promise_Q(const sim::Scene& base, const PromiseCell& cell) {
  return cell.speed_ratio * model::Q_threshold(base.oscillator.gamma_over_2omega());
}

/// That of S − K from all slips but the first, if only the paper scattered: CV/√(N − 1).
inline double expected_delta_mu_error(const PromiseCell& cell) {
  return cell.scatter / std::sqrt(static_cast<double>(cell.cycles - 1));
}

/// \param count  ≥ 3 tests, on all processors; the same result for any number of them.
inline base::Result<PromiseResult> measure_promise(const sim::Scene& base, const PromiseCell& cell,
                                                   std::int64_t count, std::uint64_t seed) {
  sweep::SweepPlan plan;
  plan.points.push_back(promise_scene(base, cell));
  plan.seeds.push_back(seed);
  plan.repeat = count;
  std::vector<std::int64_t> numbers(static_cast<std::size_t>(count));
  std::iota(numbers.begin(), numbers.end(), 0);
  std::vector<analysis::TestResults> found(numbers.size());
  const std::atomic<bool> stop{false};
  const auto take = [&](const record::SweepRun& run) -> base::Result<void> {
    found[static_cast<std::size_t>(run.number)] = run.results;
    return {};
  };
  const auto threads = static_cast<std::int64_t>(std::max(std::thread::hardware_concurrency(), 1U));
  if (auto done = sweep::do_runs(plan, numbers, threads, stop, take); !done) {
    return tl::unexpected(done.error());
  }
  PromiseResult result;
  for (const analysis::TestResults& test : found) {
    std::optional<double> traditional;
    if (test.static_coefficient.value && test.kinetic_coefficient.value) {
      traditional = *test.static_coefficient.value - *test.kinetic_coefficient.value;
    }
    result.all.traditional.add(traditional);
    // Of the fit, not of what stands in for it.
    const std::optional<double> delta_mu = test.omega.value ? test.delta_mu.value : std::nullopt;
    result.all.delta_mu.add(delta_mu);
    if (test.stick_cycle_count.value.value_or(0.0) >= 1.0) {
      result.stuck.traditional.add(traditional);
      result.stuck.delta_mu.add(delta_mu);
      if (delta_mu) result.stated.push_back(test.delta_mu.standard_error.value_or(0.0));
    }
    result.cycle_count += test.cycle_count.value.value_or(0.0) / static_cast<double>(count);
  }
  return result;
}

}  // namespace stickslip::test
