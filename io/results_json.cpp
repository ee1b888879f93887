#include "io/results_json.hpp"

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/analysis/quantities.hpp"
#include "core/record/finding_json.hpp"
#include "core/record/record.hpp"

namespace stickslip::io {
namespace {

constexpr const char* kStandardError = "standard_error";
constexpr const char* kSystematic = "systematic_uncertainty";
constexpr const char* kParts = "systematic_parts";
constexpr const char* kDiagnostics = "diagnostics";
constexpr const char* kReason = "reason";
constexpr const char* kPlace = "place";

using Object = nlohmann::ordered_json::object_t;

/// Empty, with room: without, an object copies its members each time that it grows.
nlohmann::ordered_json object_for(std::size_t count) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  json.get_ref<Object&>().reserve(count);
  return json;
}

/// Adds a member that the object does not have: operator[] compares the name with those of all members.
void append(nlohmann::ordered_json& object, std::string_view name, nlohmann::ordered_json value) {
  object.get_ref<Object&>().Object::Container::emplace_back(name, std::move(value));
}

/// The value as JSON. A result whose name ends in _count becomes an integer.
nlohmann::ordered_json number(std::string_view name, const analysis::Estimate& estimate) {
  constexpr std::string_view kCount = "_count";
  if (!estimate.value) return nullptr;
  if (name.ends_with(kCount)) return std::llround(*estimate.value);
  return *estimate.value;
}

/// {"value": …, "unit": …, "standard_error": …, …}
nlohmann::ordered_json detail_json(const analysis::ResultName& name, const analysis::Estimate& estimate) {
  constexpr std::size_t kMembers = 6;
  nlohmann::ordered_json detail = object_for(kMembers);
  append(detail, "value", number(name.name, estimate));
  append(detail, "unit", name.unit);
  if (estimate.standard_error) append(detail, kStandardError, *estimate.standard_error);
  if (estimate.systematic_uncertainty) append(detail, kSystematic, *estimate.systematic_uncertainty);
  for_each_part(estimate.systematic_parts,
                [&](analysis::UncertaintySource source, const std::optional<double>& size) {
                  if (size) detail[kParts][std::string{name_of(source).name}] = *size;
                });
  if (!estimate.value) detail[kReason] = estimate.reason;
  return detail;
}

analysis::Estimate estimate_of(const nlohmann::ordered_json& detail) {
  analysis::Estimate estimate;
  const auto take = [&detail](const char* key, std::optional<double>& into) {
    if (detail.contains(key) && !detail.at(key).is_null()) into = detail.at(key).get<double>();
  };
  take("value", estimate.value);
  take(kStandardError, estimate.standard_error);
  take(kSystematic, estimate.systematic_uncertainty);
  if (const auto parts = detail.find(kParts); parts != detail.end()) {
    for_each_part(estimate.systematic_parts,
                  [&](analysis::UncertaintySource source, std::optional<double>& size) {
                    const auto own = parts->find(name_of(source).name);
                    if (own != parts->end() && own->is_number()) size = own->get<double>();
                  });
  }
  if (!estimate.value) detail.at(kReason).get_to(estimate.reason);
  return estimate;
}

/// {"delta_mu": {"standard_error": …, "systematic_uncertainty": …}, …}, of the quantities that have errors.
nlohmann::ordered_json uncertainties_json(const analysis::TestResults& results) {
  nlohmann::ordered_json json = object_for(analysis::quantities().size());
  for (const analysis::Quantity& quantity : analysis::quantities()) {
    const analysis::Estimate& estimate = results.*quantity.estimate;
    if (!estimate.value) continue;
    constexpr std::size_t kErrors = 2;
    nlohmann::ordered_json errors = object_for(kErrors);
    for (const auto& [name, error] : {std::pair{kStandardError, &estimate.standard_error},
                                      std::pair{kSystematic, &estimate.systematic_uncertainty}}) {
      if (*error) append(errors, name, **error);
    }
    if (!errors.empty()) append(json, quantity.name, std::move(errors));
  }
  return json;
}

}  // namespace

nlohmann::ordered_json results_json(const analysis::TestResults& results, bool with_details) {
  constexpr std::size_t kMembers = 64;
  nlohmann::ordered_json json = object_for(kMembers);
  nlohmann::ordered_json details = object_for(kMembers);
  json["regime"] = model::name(results.regime);
  if (!results.regime_reason.empty()) details["regime"][kReason] = results.regime_reason;
  json["rung"] = analysis::name(results.rung);
  if (!results.rung_reason.empty()) details["rung"][kReason] = results.rung_reason;
  record::put_findings(results.findings, json);
  nlohmann::ordered_json diagnostics = object_for(kMembers);
  analysis::for_each_result(
      results, [&](const analysis::ResultName& name, const analysis::Estimate& estimate) {
        if (!name.is_diagnostic) append(json, name.name, number(name.name, estimate));
        if (name.is_diagnostic || with_details)
          append(name.is_diagnostic ? diagnostics : details, name.name, detail_json(name, estimate));
      });
  if (!results.misfit_place.empty()) details["misfit"][kPlace] = results.misfit_place;
  json[kDiagnostics] = std::move(diagnostics);
  if (with_details) {
    json["details"] = std::move(details);
  } else {
    json["uncertainties"] = uncertainties_json(results);
  }
  return json;
}

analysis::Estimate estimate_in(const nlohmann::ordered_json& results, const std::string& name) {
  const auto member = [](const nlohmann::ordered_json& json, const std::string& key) {
    const auto found = json.find(key);
    return found == json.end() ? nlohmann::ordered_json{} : *found;
  };
  const auto as_number = [](const nlohmann::ordered_json& json) {
    return json.is_number() ? std::optional{json.get<double>()} : std::nullopt;
  };
  nlohmann::ordered_json errors = member(member(results, "details"), name);
  if (!errors.is_object()) errors = member(member(results, "uncertainties"), name);
  analysis::Estimate estimate;
  estimate.value = as_number(member(results, name));
  estimate.standard_error = as_number(member(errors, kStandardError));
  estimate.systematic_uncertainty = as_number(member(errors, kSystematic));
  return estimate;
}

analysis::TestResults results_from_json(const nlohmann::ordered_json& json) {
  analysis::TestResults results;
  const nlohmann::ordered_json& details = json.at("details");
  results.regime =
      model::regime_from_name(json.at("regime").get<std::string>()).value_or(model::Regime::kUndecided);
  if (details.contains("regime")) details.at("regime").at(kReason).get_to(results.regime_reason);
  const bool has_rung = json.contains("rung");
  if (has_rung)
    results.rung =
        analysis::rung_from_name(json.at("rung").get<std::string>()).value_or(analysis::Rung::kNone);
  if (details.contains("rung")) {
    details.at("rung").at(kReason).get_to(results.rung_reason);
  } else if (!has_rung) {
    results.rung_reason = record::kNoSuchResultThen;
  }
  results.findings = record::findings_in(json);
  // Documents without this member have the diagnostics among the other results.
  const nlohmann::ordered_json& diagnostics = json.contains(kDiagnostics) ? json.at(kDiagnostics) : details;
  analysis::for_each_result(results, [&](const analysis::ResultName& name, analysis::Estimate& estimate) {
    const nlohmann::ordered_json& among = name.is_diagnostic ? diagnostics : details;
    const auto detail = among.find(std::string{name.name});
    estimate = detail == among.end() ? analysis::Estimate::none(std::string{record::kNoSuchResultThen})
                                     : estimate_of(*detail);
  });
  if (details.contains("misfit") && details.at("misfit").contains(kPlace))
    details.at("misfit").at(kPlace).get_to(results.misfit_place);
  return results;
}

}  // namespace stickslip::io
