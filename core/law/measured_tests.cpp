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

/// A test with holds, or at several speeds.
bool counts_by_rests(const MeasuredTest& test) {
  const bool held = std::any_of(test.rests.begin(), test.rests.end(),
                                [](const analysis::RestGroup& group) { return group.held; });
  const bool changes = test.speed_changes || test.results.Q.reason == analysis::kSpeedChanges;
  return held || (changes && !test.rests.empty());
}

/// Why the test counts for nothing; empty: it counts.
std::string refusal(const MeasuredTest& test) {
  const std::string_view repeated = base::kind_of(base::FindingCode::kRepeatedScans).name;
  for (const base::Finding& finding : test.results.findings) {
    if (finding.severity == base::Severity::kFault || finding.code == repeated) return finding.text;
  }
  if (counts_by_rests(test)) return {};
  if (test.speed_changes || test.results.Q.reason == analysis::kSpeedChanges)
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

/// \param test  with rests. What is off in its S or K is so in all of them.
std::vector<LawTest> tests_of_rests(const MeasuredTest& test) {
  const double of_S = test.results.mu_s.systematic_uncertainty.value_or(0.0);
  const double of_K = test.results.mu_k.systematic_uncertainty.value_or(0.0);
  std::vector<LawTest> tests;
  for (const analysis::RestGroup& group : test.rests) {
    LawTest own;
    own.pull_speed_m_per_s = group.pull_speed_m_per_s;
    own.stick_time_s = group.stick_time_s;
    own.held = group.held;
    own.S = Value{group.S, std::max(group.S_error, kLeastError), of_S + group.S_systematic};
    if (!group.held && group.K) own.K = Value{*group.K, std::max(group.K_error, kLeastError), of_K};
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
    if (counts_by_rests(measured[i])) {
      for (LawTest rest : tests_of_rests(measured[i])) {
        rest.sheet = i;
        result.tests.push_back(rest);
        result.measured.push_back(i);
      }
      continue;
    }
    LawTest test;
    test.sheet = i;
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
