/// \file
/// JSON of what may be missing: null then, never a number that nobody measured.
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace stickslip::io {

/// JSON has no infinity and no NaN.
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

/// As above: a number that is no number is missing as well.
[[nodiscard]] inline nlohmann::ordered_json or_null(const std::optional<double>& value) {
  if (!value) return nullptr;
  return or_null(*value);
}

}  // namespace stickslip::io
