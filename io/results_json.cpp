#include "io/results_json.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace stickslip::io {
namespace {

/// The value as JSON. A result whose name ends in _count becomes an integer.
nlohmann::ordered_json number(const std::string& name, const analysis::Estimate& estimate) {
  constexpr std::string_view kCount = "_count";
  if (!estimate.value) return nullptr;
  if (name.ends_with(kCount)) return std::llround(*estimate.value);
  return *estimate.value;
}

}  // namespace

nlohmann::ordered_json results_json(const analysis::TestResults& results, bool with_details) {
  nlohmann::ordered_json json;
  nlohmann::ordered_json details;
  json["regime"] = model::name(results.regime);
  if (!results.regime_reason.empty()) details["regime"]["reason"] = results.regime_reason;
  json["findings"] = results.findings;
  analysis::for_each_result(results,
                            [&](const analysis::ResultName& name, const analysis::Estimate& estimate) {
                              const std::string key{name.name};
                              json[key] = number(key, estimate);
                              nlohmann::ordered_json& detail = details[key];
                              detail["value"] = json[key];
                              detail["unit"] = name.unit;
                              if (estimate.standard_error)
                                detail["standard_error"] = *estimate.standard_error;
                              if (estimate.systematic_uncertainty)
                                detail["systematic_uncertainty"] = *estimate.systematic_uncertainty;
                              if (!estimate.value) detail["reason"] = estimate.reason;
                            });
  if (with_details) json["details"] = std::move(details);
  return json;
}

analysis::TestResults results_from_json(const nlohmann::ordered_json& json) {
  analysis::TestResults results;
  const nlohmann::ordered_json& details = json.at("details");
  results.regime =
      model::regime_from_name(json.at("regime").get<std::string>()).value_or(model::Regime::kUndecided);
  if (details.contains("regime")) details.at("regime").at("reason").get_to(results.regime_reason);
  json.at("findings").get_to(results.findings);
  analysis::for_each_result(results, [&](const analysis::ResultName& name, analysis::Estimate& estimate) {
    const nlohmann::ordered_json& detail = details.at(std::string{name.name});
    const auto take = [&detail](const char* key, std::optional<double>& into) {
      if (detail.contains(key) && !detail.at(key).is_null()) into = detail.at(key).get<double>();
    };
    take("value", estimate.value);
    take("standard_error", estimate.standard_error);
    take("systematic_uncertainty", estimate.systematic_uncertainty);
    if (!estimate.value) detail.at("reason").get_to(estimate.reason);
  });
  return results;
}

}  // namespace stickslip::io
