/// \file
/// Reads the body of a request as JSON, and makes text from outside safe to show.
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

/// Text from a request, made safe for a reply and cut to 100 characters.
[[nodiscard]] inline std::string printable(const std::string& text) { return base::one_line(text, 100); }

/// The JSON object in a body; an empty body is an empty object. \param keys  the allowed keys; empty: all.
/// Errors: kUsage.
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
