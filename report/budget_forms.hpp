/// \file
/// Uncertainty budgets (core/analysis/uncertainty_budget) of S − K, static and kinetic as text and as JSON.
///
///                               S−K            static         kinetic
///     source           type     size    %      size    %      size    %
///     noise            A     0.00035   12         …
///     U, k = 2               0.0091
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/analysis/group_budget.hpp"
#include "core/record/record.hpp"

namespace stickslip::report {

/// One for each of analysis::kBudgetQuantities; nullopt where the quantity has no value.
using Budgets = std::array<std::optional<analysis::UncertaintyBudget>, analysis::kBudgetQuantities.size()>;

/// What a record says of the converter, the speed and the method.
[[nodiscard]] analysis::BudgetFacts budget_facts_of(const record::RecordHeader& header);

[[nodiscard]] Budgets budgets_of(const analysis::TestResults& results, const analysis::BudgetFacts& facts);
[[nodiscard]] Budgets budgets_of(std::span<const analysis::MeasuredTest> tests,
                                 const analysis::SpeedGroup& group);

/// "S−K = 0.0463 ± 0.0091 (k = 2)", with the sources that are not known.
[[nodiscard]] std::string statement_of(const analysis::Quantity& quantity,
                                       const analysis::UncertaintyBudget& budget);

/// The table, at most 80 columns wide, the statements and what to do about unknown sources; empty without a
/// budget.
[[nodiscard]] std::string budget_text(const Budgets& budgets);

/// {"delta_mu": {"value", "lines": [{"source", "title", "type", "state", "standard_uncertainty", "share",
/// "note"}], "combined_standard_uncertainty", "expanded_uncertainty", "coverage_factor", "coverage",
/// "statement"}, …}; null without a value.
[[nodiscard]] nlohmann::ordered_json budgets_json(const Budgets& budgets);

}  // namespace stickslip::report
