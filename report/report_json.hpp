/// \file
/// Reports as JSON and CSV, in SI units and with the names of the record. A missing number is null or an
/// empty cell, with the reason beside it.
#pragma once

#include <span>
#include <string>

#include "report/test_report.hpp"
#include <nlohmann/json_fwd.hpp>

namespace stickslip::report {

/// {"form": [{"name", "label", "values", "not_stated", "text"}], "verdict", "not_pooled",
///  "tests": [{"file", "title", "method", "estimator", "departures", "pull_speed", "pull_speed_text",
///  "regime", "rung", results
/// …, "diagnostics", "details"}],
///  "groups": [{"pull_speed", "pull_speed_text", "text", "grades", "regimes", "tests": [index …],
///  "delta_mu_by_cycle": pooled_json(), "quantities": {NAME:
///  {"unit", "count", "mean",
///    "standard_deviation", "repeatability", "confidence_interval", "coverage_factor", "outlier",
///    "systematic_uncertainty", "absent"}}}],
///  "pooled_standard_deviation": {NAME: …}}
[[nodiscard]] nlohmann::ordered_json report_json(const Material& material);

/// {"a": report_json() and "label", "b": …, "comparisons": [{"pull_speed", "regime":
///    {"a_sticking", "a_sliding", "b_sticking", "b_sliding", "p"}, "delta_mu_by_cycle":
///    {"difference", "confidence_interval", "t", "degrees_of_freedom", "p", "reason"}, "quantities": {NAME:
///    {"difference", "confidence_interval", "t", "degrees_of_freedom", "p", "hedges_g",
///     "hedges_g_interval", "tests_needed_80", "tests_needed_90", "reason"}}}],
///  "combined": {NAME: {"p", "speeds"}}}
[[nodiscard]] nlohmann::ordered_json comparison_json(const Material& a, const Material& b,
                                                     const MaterialComparison& comparison);

/// CSV (RFC 4180) with a header and one line for each test.
[[nodiscard]] std::string report_csv(const Material& material);

/// CSV with a header and one line for each speed and quantity.
[[nodiscard]] std::string comparison_csv(const Material& a, const Material& b,
                                         const MaterialComparison& comparison);

}  // namespace stickslip::report
