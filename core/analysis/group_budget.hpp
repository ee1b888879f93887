/// \file
/// Uncertainty budget of the mean of replicates.
#pragma once

#include <optional>
#include <span>

#include "core/analysis/grouping.hpp"
#include "core/analysis/uncertainty_budget.hpp"

namespace stickslip::analysis {

/// Uncertainty budget of the mean of a quantity over a group. For S − K this is the mean by cycle
/// (SpeedGroup::by_cycle) where that has a standard error; else, and for other quantities, the mean of the
/// tests. The standard error of the mean, by the scatter of the tests, replaces the noise. The systematic
/// uncertainty is that of the group's mean; its parts are the means over the tests that have a systematic
/// uncertainty. If a single test has a value, the budget is that test's; nullopt if none has.
/// \param tests  all tests: the indices in `group` refer to them.
/// \param quantity  index of quantities(), one of kBudgetQuantities.
[[nodiscard]] std::optional<UncertaintyBudget> group_budget(std::span<const MeasuredTest> tests,
                                                            const SpeedGroup& group, std::size_t quantity);

}  // namespace stickslip::analysis
