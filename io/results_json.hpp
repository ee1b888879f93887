/// \file
/// Results by the names of the record, as JSON: the same for the control interface and for
/// `stickslip analyze --json`.
///
///     {"regime": "stick-slip", "cycle_count": 97, "mu_s": 0.35, "gamma_over_2omega": null, …,
///      "details": {"mu_s": {"value": 0.35, "unit": "1", "standard_error": 1e-4}, …,
///                  "gamma_over_2omega": {"value": null, "unit": "1", "reason": "…"}}}
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/analysis/results.hpp"

namespace stickslip::io {

/// Order of the record. A result that is absent is null.
/// \param with_details  adds "details": value, unit and, where there are such, standard_error,
///                      systematic_uncertainty and the reason of an absence.
[[nodiscard]] nlohmann::ordered_json results_json(const analysis::TestResults& results, bool with_details);

/// The results that results_json(results, true) made this of. \throws nlohmann::json::exception if it did
/// not.
[[nodiscard]] analysis::TestResults results_from_json(const nlohmann::ordered_json& json);

}  // namespace stickslip::io
