/// \file
/// Findings in JSON: the sentences under "findings", which is all that older documents have, and the whole
/// findings under "coded_findings".
///
///     {"findings": ["zero: …"],
///      "coded_findings": [{"code": "zero-offset", "severity": "warning", "text": "zero: …",
///                          "action": "tare …",
///                          "numbers": [{"name": "offset", "value": -0.04, "unit": "1"}]}]}
#pragma once

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/base/finding.hpp"

namespace stickslip::record {

inline constexpr const char* kFindings = "findings";
inline constexpr const char* kCodedFindings = "coded_findings";

/// \param numbers  finite, as make_finding() leaves them: JSON has no others.
template <typename Json>
[[nodiscard]] Json numbers_json(std::span<const base::FindingNumber> numbers) {
  Json list = Json::array();
  for (const base::FindingNumber& number : numbers)
    list.push_back({{"name", number.name}, {"value", number.value}, {"unit", number.unit}});
  return list;
}

/// Inverse of numbers_json(). \throws nlohmann::json::exception if an entry lacks a key or has another type.
template <typename Json>
[[nodiscard]] std::vector<base::FindingNumber> numbers_from_json(const Json& list) {
  std::vector<base::FindingNumber> numbers;
  for (const Json& number : list) {
    numbers.push_back({number.at("name").template get<std::string>(),
                       number.at("value").template get<double>(),
                       number.at("unit").template get<std::string>()});
  }
  return numbers;
}

template <typename Json>
[[nodiscard]] Json findings_json(std::span<const base::Finding> findings) {
  Json list = Json::array();
  for (const base::Finding& finding : findings) {
    list.push_back({{"code", finding.code},
                    {"severity", base::name(finding.severity)},
                    {"text", finding.text},
                    {"action", finding.action},
                    {"numbers", numbers_json<Json>(finding.numbers)}});
  }
  return list;
}

/// Sets both keys of the object.
template <typename Json>
void put_findings(std::span<const base::Finding> findings, Json& object) {
  object[kFindings] = base::texts_of(findings);
  object[kCodedFindings] = findings_json<Json>(findings);
}

/// Reads the findings of an object: the whole ones under "coded_findings", else each sentence under
/// "findings" as kUncoded. Empty if it has neither key. An unknown severity counts as a warning.
/// \throws nlohmann::json::exception if an entry lacks a key or has another type.
template <typename Json>
[[nodiscard]] std::vector<base::Finding> findings_in(const Json& object) {
  std::vector<base::Finding> findings;
  if (const auto coded = object.find(kCodedFindings); coded != object.end()) {
    for (const Json& one : *coded) {
      findings.push_back({one.at("code").template get<std::string>(),
                          base::severity_from_name(one.at("severity").template get<std::string>())
                              .value_or(base::Severity::kWarning),
                          one.at("text").template get<std::string>(),
                          one.at("action").template get<std::string>(),
                          numbers_from_json(one.at("numbers"))});
    }
  } else if (const auto texts = object.find(kFindings); texts != object.end()) {
    for (const Json& text : *texts)
      findings.push_back(base::make_finding(base::FindingCode::kUncoded, text.template get<std::string>()));
  }
  return findings;
}

}  // namespace stickslip::record
