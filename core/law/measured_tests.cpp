#include "core/law/measured_tests.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/finding.hpp"

namespace stickslip::law {
namespace {

using analysis::Estimate;
using analysis::MeasuredTest;

/// Of values none of which has an error: the scatter between tests tells it.
constexpr double kLeastError = 1e-6;

/// Why the test counts for nothing; empty: it counts.
std::string refusal(const MeasuredTest& test) {
  const std::string_view repeated = base::kind_of(base::FindingCode::kRepeatedScans).name;
  for (const base::Finding& finding : test.results.findings) {
    if (finding.severity == base::Severity::kFault || finding.code == repeated) return finding.text;
  }
  if (!test.rests.empty()) return {};
  if (test.results.Q.reason == analysis::kSpeedChanges)
    return std::string{analysis::kSpeedChanges} + ": S and K are means over many";
  if (!test.pull_speed_m_per_s || !(*test.pull_speed_m_per_s > 0.0)) return "the pull speed is not known";
  return {};
}

/// \return error 0 where none is known.
std::optional<Value> value_of(const Estimate& estimate, analysis::Rung rung) {
  if (!estimate.value) return std::nullopt;
  Value value{*estimate.value, estimate.standard_error.value_or(0.0),
              estimate.systematic_uncertainty.value_or(0.0)};
  if (rung == analysis::Rung::kTurningPoints) {
    value.error = std::hypot(value.error, value.systematic);
    value.systematic = 0.0;
  }
  return value;
}

/// Error of S − K that all slips of a test share by omega, gamma and the stick rate, over S − K.
double shared_part_of(const analysis::TestResults& results) {
  const std::optional<double>& delta_mu = results.delta_mu.value;
  return delta_mu && *delta_mu > 0.0 ? results.delta_mu.standard_error.value_or(0.0) / *delta_mu : 0.0;
}

/// \param test  with rests.
std::vector<LawTest> tests_of_rests(const MeasuredTest& test) {
  const analysis::TestResults& results = test.results;
  const std::optional<Value> K = value_of(results.mu_k, results.rung);
  const std::optional<Value> S = value_of(results.mu_s, results.rung);
  const double shared = shared_part_of(results);
  std::vector<LawTest> tests;
  for (const analysis::RestGroup& group : test.rests) {
    LawTest own;
    own.pull_speed_m_per_s = group.pull_speed_m_per_s;
    own.stick_time_s = group.stick_time_s;
    own.held = group.held;
    const double of_all = shared * group.delta_mu;
    const double own_part = group.delta_mu_error * group.delta_mu_error - of_all * of_all;
    own.S = Value{group.K + group.delta_mu, std::sqrt(std::max(own_part, kLeastError * kLeastError)), 0.0};
    // The scans tell S, and an error of S - K is one of K the other way: it counts where S - K differs.
    if (S)
      own.S->systematic =
          std::hypot(S->systematic, S->error + shared * std::abs(group.delta_mu - (S->value - K->value)));
    if (!group.held) own.K = Value{group.K, std::max(group.K_error, K->error), K->systematic};
    tests.push_back(own);
  }
  return tests;
}

void fill_errors(std::vector<LawTest>& tests, std::optional<Value> LawTest::*value) {
  double largest = kLeastError;
  for (const LawTest& test : tests) {
    if (test.*value) largest = std::max(largest, (test.*value)->error);
  }
  for (LawTest& test : tests) {
    if (test.*value && !((test.*value)->error > 0.0)) (test.*value)->error = largest;
  }
}

}  // namespace

LawTests tests_for_law(std::span<const MeasuredTest> measured) {
  LawTests result;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const analysis::TestResults& results = measured[i].results;
    if (std::string reason = refusal(measured[i]); !reason.empty()) {
      result.left_out.push_back({i, "S and K", std::move(reason)});
      continue;
    }
    if (!measured[i].rests.empty()) {
      for (const LawTest& rest : tests_of_rests(measured[i])) {
        result.tests.push_back(rest);
        result.measured.push_back(i);
      }
      continue;
    }
    LawTest test;
    test.pull_speed_m_per_s = *measured[i].pull_speed_m_per_s;
    test.stick_time_s = measured[i].stick_time_s;
    const bool steady = results.regime == model::Regime::kSteadySliding;
    const Estimate& K = steady && !results.mu_k.value ? results.kinetic_coefficient : results.mu_k;
    test.K = value_of(K, results.rung);
    if (test.stick_time_s) test.S = value_of(results.mu_s, results.rung);
    if (!test.S) {
      result.left_out.push_back(
          {i, "S", results.mu_s.value ? "no slip began from a stick of known time" : results.mu_s.reason});
    }
    if (!test.K) result.left_out.push_back({i, "K", K.reason});
    if (!test.S && !test.K) continue;
    result.tests.push_back(test);
    result.measured.push_back(i);
  }
  fill_errors(result.tests, &LawTest::S);
  fill_errors(result.tests, &LawTest::K);
  return result;
}

}  // namespace stickslip::law
