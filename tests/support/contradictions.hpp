/// \file
/// What in the results of a test contradicts itself: asked without the model that made the results, of each
/// pair of numbers that physics ties together.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "core/analysis/results.hpp"
#include "core/base/finding.hpp"

namespace stickslip::test {

/// Standard errors that two numbers may differ by: both kinds of error of both numbers.
inline constexpr double kContradictionSigmas = 4.0;

/// Pairs of a test that contradict each other, one text each with the values; empty if none does.
/// \param planned_speed_m_per_s  of the pull; absent where it changes: then Q and the frequency are no
///        constants.
inline std::vector<std::string> contradictions(const analysis::TestResults& results,
                                               std::optional<double> planned_speed_m_per_s) {
  using analysis::Estimate;
  using model::Regime;
  std::vector<std::string> found;
  const auto error = [](const Estimate& estimate) {
    return std::hypot(kContradictionSigmas * estimate.standard_error.value_or(0.0),
                      estimate.systematic_uncertainty.value_or(0.0));
  };
  const auto note = [&](const char* what, double a, double b) {
    found.push_back(std::string{what} + ": " + std::to_string(a) + ", " + std::to_string(b));
  };
  // Signs, and errors that are no numbers.
  analysis::for_each_result(results, [&](const analysis::ResultName& name, const Estimate& estimate) {
    const auto is_error = [](const std::optional<double>& value) {
      return !value || (std::isfinite(*value) && *value >= 0.0);
    };
    if (!is_error(estimate.standard_error) || !is_error(estimate.systematic_uncertainty))
      note("error of a result", estimate.standard_error.value_or(0.0),
           estimate.systematic_uncertainty.value_or(0.0));
    if (estimate.value.has_value() == !estimate.reason.empty())
      found.push_back("value and reason: " + std::string{name.name});
  });
  for (const Estimate* positive : {&results.delta_mu, &results.Q, &results.Q_threshold, &results.omega,
                                   &results.amplitude, &results.period_median, &results.threshold_speed}) {
    if (positive->value && !(*positive->value > 0.0)) note("sign", *positive->value, 0.0);
  }
  const Estimate &S = results.mu_s, &K = results.mu_k, &D = results.delta_mu;
  if (S.value && K.value && D.value &&
      std::abs(*S.value - *K.value - *D.value) > error(S) + error(K) + error(D))
    note("S less K, S - K", *S.value - *K.value, *D.value);
  // Regime, counts, and what the threshold allows [22]; slips scatter about the mean Q.
  const double all = results.cycle_count.value.value_or(0.0);
  const std::optional<double> captured = results.stick_cycle_count.value;
  const bool never_rests =
      results.regime == Regime::kRingDown || results.regime == Regime::kInertialOscillation;
  if (captured && (*captured > all || (never_rests && *captured > 0.0) ||
                   (results.regime == Regime::kStickSlip && all > 2.0 && *captured < 0.5 * (all - 2.0)) ||
                   (results.regime == Regime::kMixed && (*captured == 0.0 || *captured == all))))
    note("regime and captured slips", *captured, all);
  if (planned_speed_m_per_s && results.Q.value && results.Q_threshold.value && D.value) {
    constexpr double kMargin = 1.2;
    const double cv = std::min(0.3, results.delta_mu_scatter.value.value_or(0.0) / *D.value);
    const double errors = 1.0 + (error(results.Q) + error(results.Q_threshold)) / *results.Q.value;
    const double ratio = *results.Q.value / *results.Q_threshold.value;
    const double margin = kMargin * errors * (1.0 + 3.0 * cv);
    const bool some_free = results.regime == Regime::kMixed || results.regime == Regime::kRingDown;
    const bool some_captured = results.regime == Regime::kMixed || results.regime == Regime::kStickSlip;
    if (some_free && ratio * margin < 1.0) note("free slips below the threshold", ratio, margin);
    if (some_captured && ratio > margin) note("captures above the threshold", ratio, margin);
  }
  // An oscillation with rests is never faster than one without.
  if (planned_speed_m_per_s && results.omega.value && results.period_median.value &&
      results.regime == Regime::kStickSlip) {
    const double free_s = 2.0 * std::numbers::pi / *results.omega.value;
    const double share = error(results.omega) / *results.omega.value +
                         error(results.period_median) / *results.period_median.value;
    if (*results.period_median.value * (1.0 + share + 0.05) < free_s)
      note("period and free period", *results.period_median.value, free_s);
  }
  // Without damping the half range is √(1 + Q²) (S − K), with damping less; at least half of it with e ≥ 0.
  if (planned_speed_m_per_s && D.value && results.amplitude.value && results.regime == Regime::kStickSlip) {
    // Where the speed changes it has no Q; stick-slip is below the threshold.
    const double Q = results.Q.value.value_or(results.Q_threshold.value.value_or(1.0));
    const double most = std::hypot(1.0, Q) * (*D.value + error(D));
    const double least = 0.5 * (*D.value - error(D));
    const double half_range = *results.amplitude.value, own = error(results.amplitude);
    if (half_range - own > 1.05 * most || half_range + own < least)
      note("S - K and the half range", *D.value, half_range);
  }
  if (planned_speed_m_per_s && results.pull_speed_measured.value) {
    constexpr double kTolerance = 0.05;
    const double speed = *results.pull_speed_measured.value;
    const bool told =
        std::any_of(results.findings.begin(), results.findings.end(), [](const base::Finding& finding) {
          return finding.code == base::kind_of(base::FindingCode::kPullSpeed).name;
        });
    if (!told && std::abs(speed - *planned_speed_m_per_s) >
                     kTolerance * *planned_speed_m_per_s + error(results.pull_speed_measured))
      note("pull speed measured and planned", speed, *planned_speed_m_per_s);
  }
  return found;
}

}  // namespace stickslip::test
