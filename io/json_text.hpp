/// \file
/// JSON as text: valid UTF-8 whose strings deceive no eye. The same JSON reads back.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "core/base/text.hpp"

namespace stickslip::io {

/// On one line. Bytes of a string that are no UTF-8 are replaced by U+FFFD; what base::printable() would
/// show by its number is escaped.
[[nodiscard]] inline std::string json_text(const nlohmann::ordered_json& json) {
  return base::printable_lines(json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

/// On lines indented by two blanks, with a line feed at the end: for people and files.
[[nodiscard]] inline std::string json_document(const nlohmann::ordered_json& json) {
  return base::printable_lines(json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)) +
         "\n";
}

}  // namespace stickslip::io
