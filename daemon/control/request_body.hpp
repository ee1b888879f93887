/// \file
/// The body of a request as JSON, and what came from outside as text that may be shown.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "core/base/result.hpp"

namespace stickslip::daemon {

/// A request line may hold any bytes; an answer may not.
[[nodiscard]] inline std::string printable(const std::string& text) {
  constexpr std::size_t kLongest = 100;
  std::string shown;
  for (const char c : text.substr(0, kLongest)) shown += c >= 0x20 && c < 0x7F ? c : '?';
  return shown;
}

/// The JSON object of a body, with no keys but these, any if none are named; an empty body is an empty
/// object.
[[nodiscard]] inline base::Result<nlohmann::ordered_json> object_of(
    const std::string& body, std::initializer_list<std::string_view> keys) {
  if (body.empty()) return nlohmann::ordered_json::object();
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(body, nullptr, false);
  if (!json.is_object()) return base::usage_error("the body must be a JSON object");
  for (const auto& [key, value] : json.items()) {
    if (keys.size() > 0 && std::find(keys.begin(), keys.end(), key) == keys.end()) {
      return base::usage_error("\"{}\": there is no such key; there is {}", printable(key),
                               fmt::join(keys, ", "));
    }
  }
  return json;
}

}  // namespace stickslip::daemon
