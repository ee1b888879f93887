/// \file
/// Uncertainty budget of the mean of replicates.
#pragma once

#include <optional>
#include <span>

#include "core/analysis/grouping.hpp"
#include "core/analysis/uncertainty_budget.hpp"

namespace stickslip::analysis {

/// Budget of a group's number: of S − K the mean by cycle where it has a standard error, else the mean of the
/// tests. Of one test it is that test's. The standard error of the mean, by the scatter of the tests,
/// replaces the noise; the systematic uncertainty is that of the group, and its parts are the means of those
/// of the tests that have one. nullopt if no test has a value. \param tests  all tests, of which group has
/// indices. \param quantity  index of quantities(), one of kBudgetQuantities.
[[nodiscard]] std::optional<UncertaintyBudget> group_budget(std::span<const MeasuredTest> tests,
                                                            const SpeedGroup& group, std::size_t quantity);

}  // namespace stickslip::analysis
