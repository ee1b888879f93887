/// \file
/// Answers of the control interface as JSON.
#pragma once

#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/base/text.hpp"
#include "daemon/control/http.hpp"

namespace stickslip::daemon {

/// Names of files and boards come from outside: bytes that are no UTF-8 are replaced, and what deceives the
/// eye is written by its number, which JSON reads as the same text.
[[nodiscard]] inline std::string text_of(const nlohmann::ordered_json& json) {
  return base::printable_lines(json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

[[nodiscard]] inline HttpReply reply_of(const nlohmann::ordered_json& json) {
  return {200, text_of(json), {}};
}

/// \param allow  the methods that are, for 405.
[[nodiscard]] inline HttpReply refusal(int status, const std::string& why, std::string allow = {}) {
  return {status, text_of({{"error", why}}), std::move(allow)};
}

}  // namespace stickslip::daemon
