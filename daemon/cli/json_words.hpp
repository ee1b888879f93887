/// \file
/// Members of a daemon's answer as words for people.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace stickslip::daemon {

/// A text of the object; a dash if it has none of that name.
[[nodiscard]] std::string word(const nlohmann::ordered_json& json, const char* key);

/// A number of the object; a dash if it has none of that name.
[[nodiscard]] std::string number(const nlohmann::ordered_json& json, const char* key, int decimals);

}  // namespace stickslip::daemon
