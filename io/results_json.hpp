/// \file
/// Results as JSON, with the names of the record, for the control interface and for `stickslip analyze
/// --json`.
///
///     {"regime": "stick-slip", "rung": "two-parameter-law", "cycle_count": 97, "mu_s": 0.35,
///      "gamma_over_2omega": null, …,
///      "diagnostics": {"delta_mu_combined": {"value": 0.05, "unit": "1", "standard_error": 1e-4}, …},
///      "details": {"mu_s": {"value": 0.35, "unit": "1", "standard_error": 1e-4}, …,
///                  "gamma_over_2omega": {"value": null, "unit": "1", "reason": "…"}}}
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/analysis/results.hpp"

namespace stickslip::io {

/// All results, in the order of the record, and those that are diagnostics with their details in a member of
/// their own. An absent result is null.
/// \param with_details  adds "details": value, unit and, where known, standard_error, systematic_uncertainty,
/// systematic_parts (an object of the parts' sizes) and the reason for an absent value. Else adds
/// "uncertainties": those two of the quantities that have them.
[[nodiscard]] nlohmann::ordered_json results_json(const analysis::TestResults& results, bool with_details);

/// Reads what results_json(results, true) made, of this version or one before. \throws
/// nlohmann::json::exception for other JSON.
[[nodiscard]] analysis::TestResults results_from_json(const nlohmann::ordered_json& json);

/// One result of such JSON, with its errors from "details" or "uncertainties"; of other JSON without a value.
/// The reason is left empty. \param results  may lack the result, as that of another version.
[[nodiscard]] analysis::Estimate estimate_in(const nlohmann::ordered_json& results, const std::string& name);

}  // namespace stickslip::io
