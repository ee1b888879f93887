/// \file
/// S − K pooled by cycle as JSON, for reports and for the summary of the latest tests; and the sums over one
/// test that pooling needs.
#pragma once

#include "io/or_null.hpp"
#include <nlohmann/json.hpp>

#include "core/analysis/pooled.hpp"

namespace stickslip::io {

/// {"value", "standard_error", "systematic_uncertainty", "confidence_interval", "tests", "slips", "escaped",
///  "scatter", "captured_alone", "reason" (only if "value" is null)}
[[nodiscard]] inline nlohmann::ordered_json pooled_json(const analysis::PooledDeltaMu& pooled) {
  const std::optional<analysis::Interval> interval = analysis::mean_interval(pooled);
  nlohmann::ordered_json json{{"value", or_null(pooled.mean.value)},
                              {"standard_error", or_null(pooled.mean.standard_error)},
                              {"systematic_uncertainty", or_null(pooled.mean.systematic_uncertainty)},
                              {"confidence_interval", nullptr},
                              {"tests", pooled.test_count},
                              {"slips", pooled.slip_count},
                              {"escaped", pooled.escaped_count},
                              {"scatter", or_null(pooled.scatter.value)},
                              {"captured_alone", or_null(pooled.captured_mean.value)}};
  if (interval) json["confidence_interval"] = {interval->low, interval->high};
  if (!pooled.mean.value) json["reason"] = pooled.mean.reason;
  return json;
}

/// {"count", "sum", "square_sum", "captured_count", "captured_sum", "escaped_count"}
[[nodiscard]] inline nlohmann::ordered_json slip_sums_json(const analysis::SlipSums& sums) {
  return {{"count", sums.count},
          {"sum", sums.sum},
          {"square_sum", sums.square_sum},
          {"captured_count", sums.captured_count},
          {"captured_sum", sums.captured_sum},
          {"escaped_count", sums.escaped_count}};
}

/// Reads what slip_sums_json() made. \throws nlohmann::json::exception for other JSON.
[[nodiscard]] inline analysis::SlipSums slip_sums_from_json(const nlohmann::ordered_json& json) {
  const auto number = [&json](const char* key) { return json.at(key).get<double>(); };
  return {.count = number("count"),
          .sum = number("sum"),
          .square_sum = number("square_sum"),
          .captured_count = number("captured_count"),
          .captured_sum = number("captured_sum"),
          .escaped_count = number("escaped_count")};
}

}  // namespace stickslip::io
