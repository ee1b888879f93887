// Whatever is added in whatever order: the parts make the total, and a budget's shares are a whole.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/analysis/uncertainty_budget.hpp"

namespace stickslip::analysis {
namespace {

/// 0, or over eight decades.
double size() {
  const int decades_in_hundredths = *rc::gen::inRange(-601, 201);
  return decades_in_hundredths == -601 ? 0.0 : std::pow(10.0, decades_in_hundredths / 100.0);
}

/// The sources of analysis first, in any order, then those of the facts, as add_facts() has it.
Estimate any_estimate() {
  Estimate estimate = Estimate::of(0.3, size());
  const auto first = static_cast<int>(UncertaintySource::kDamping);
  const int count = *rc::gen::inRange(0, 6);
  for (int i = 0; i < count; ++i) {
    const int source = *rc::gen::inRange(first, static_cast<int>(kUncertaintySourceCount));
    add_systematic(estimate, static_cast<UncertaintySource>(source), size());
  }
  for (const auto source : {UncertaintySource::kCalibration, UncertaintySource::kZero}) {
    if (*rc::gen::arbitrary<bool>()) add_systematic(estimate, source, size());
  }
  return estimate;
}

RC_GTEST_PROP(Uncertainty, PartsMakeTheTotalWhichIsNeverBelowOne, ()) {
  const Estimate estimate = any_estimate();
  const double total = estimate.systematic_uncertainty.value_or(0.0);
  const double rounding = 1e-12 * total;
  RC_ASSERT(std::abs(total_of(estimate.systematic_parts) - total) <= rounding);
  const Contributions contributions = contributions_of(estimate);
  double sum = contributions.unnamed;
  for_each_part(estimate.systematic_parts, [&](UncertaintySource source, const std::optional<double>& part) {
    RC_ASSERT(part.value_or(0.0) <= total + rounding);
    sum += contributions.of[static_cast<std::size_t>(source)];
  });
  RC_ASSERT(std::abs(sum - total) <= rounding);
}

RC_GTEST_PROP(Uncertainty, ABudgetIsWholeAndNeverBelowItsLargestLine, ()) {
  TestResults results;
  results.delta_mu = any_estimate();
  const auto budget = test_budget(results, quantities()[kBudgetQuantities[0]], {});
  RC_ASSERT(budget && budget->combined);
  const double combined = *budget->combined;
  const double expected =
      std::hypot(*results.delta_mu.standard_error, results.delta_mu.systematic_uncertainty.value_or(0.0));
  RC_ASSERT(std::abs(combined - expected) <= 1e-12 * expected);
  double shares = 0.0;
  for (const BudgetLine& line : budget->lines) {
    if (line.state != BudgetState::kCounted) continue;
    RC_ASSERT(line.size.value_or(0.0) <= combined * (1.0 + 1e-12));
    shares += budget->share_of(line);
  }
  RC_ASSERT(combined == 0.0 || std::abs(shares - 1.0) <= 1e-12);
}

}  // namespace
}  // namespace stickslip::analysis
