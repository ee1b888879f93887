/// \file
/// Numbers of traces as JSON, with the digits that a page can show.
#pragma once

#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>

namespace stickslip::report {

/// Rounded to 1e-6 (s, coefficient); null if not finite.
[[nodiscard]] inline nlohmann::ordered_json rounded(double value) {
  constexpr double kStepsPerUnit = 1e6;
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * kStepsPerUnit) / kStepsPerUnit;
}

[[nodiscard]] inline nlohmann::ordered_json rounded(const std::vector<double>& values) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  json.get_ref<nlohmann::ordered_json::array_t&>().reserve(values.size());
  for (const double value : values) json.push_back(rounded(value));
  return json;
}

}  // namespace stickslip::report
