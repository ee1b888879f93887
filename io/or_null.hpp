/// \file
/// JSON of values that may be missing: null marks a missing value.
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace stickslip::io {

/// null if the value is infinite or NaN, which JSON cannot hold.
[[nodiscard]] inline nlohmann::ordered_json or_null(double value) {
  if (!std::isfinite(value)) return nullptr;
  return value;
}

[[nodiscard]] inline nlohmann::ordered_json or_null(const std::string& text) {
  if (text.empty()) return nullptr;
  return text;
}

template <typename T>
[[nodiscard]] nlohmann::ordered_json or_null(const std::optional<T>& value) {
  if (!value) return nullptr;
  return *value;
}

/// null if the value is absent, infinite or NaN.
[[nodiscard]] inline nlohmann::ordered_json or_null(const std::optional<double>& value) {
  if (!value) return nullptr;
  return or_null(*value);
}

}  // namespace stickslip::io
