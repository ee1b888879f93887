/// \file
/// JSON as text in valid UTF-8, safe to show on a terminal: control and other misleading characters are
/// escaped. The text reads back as the same JSON.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "core/base/text.hpp"

namespace stickslip::io {

/// The JSON on one line. U+FFFD replaces bytes that are not UTF-8. Characters that base::printable() would
/// show by their number are escaped.
[[nodiscard]] inline std::string json_text(const nlohmann::ordered_json& json) {
  return base::printable_lines(json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

/// The JSON on lines, indented by two blanks, with a final line feed: for people and files.
[[nodiscard]] inline std::string json_document(const nlohmann::ordered_json& json) {
  return base::printable_lines(json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)) +
         "\n";
}

}  // namespace stickslip::io
