/// \file
/// Members of a daemon's answer as text for people.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "core/base/result.hpp"

namespace stickslip::cli {

/// A text of the object; a dash if it has none of that name.
[[nodiscard]] std::string word(const nlohmann::ordered_json& json, const char* key);

/// The JSON as the body of a request. Usage error: a text typed that is no UTF-8.
[[nodiscard]] base::Result<std::string> body_of(const nlohmann::ordered_json& json);

/// A number of the object; a dash if it has none of that name.
[[nodiscard]] std::string number(const nlohmann::ordered_json& json, const char* key, int decimals);

/// A coefficient of results_json() with its errors: "0.0470 ± 0.0027 ± 0.0019"; a dash if there is none.
[[nodiscard]] std::string coefficient(const nlohmann::ordered_json& results, const char* name);

}  // namespace stickslip::cli
