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
#include "core/base/text.hpp"
#include "core/base/wording.hpp"

namespace stickslip::control {

/// A request line may hold any bytes; an answer may not.
[[nodiscard]] inline std::string printable(const std::string& text) { return base::one_line(text, 100); }

/// The JSON object of a body, with no keys but these, any if none are named; an empty body is an empty
/// object.
[[nodiscard]] inline base::Result<nlohmann::ordered_json> object_of(
    const std::string& body, std::initializer_list<std::string_view> keys) {
  if (body.empty()) return nlohmann::ordered_json::object();
  if (!base::is_utf8(body)) return base::usage_error("the body: {}", base::name_refusal(body));
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

}  // namespace stickslip::control
