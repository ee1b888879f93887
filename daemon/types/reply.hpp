/// \file
/// Replies of the control interface with a body of JSON.
#pragma once

#include <string>
#include <utility>

#include "io/json_text.hpp"
#include <nlohmann/json.hpp>

#include "daemon/types/http.hpp"

namespace stickslip::daemon {

[[nodiscard]] inline HttpReply reply_of(const nlohmann::ordered_json& json) {
  return {200, io::json_text(json), {}};
}

/// {"error": why}. \param allow  the allowed methods, for status 405.
[[nodiscard]] inline HttpReply refusal(int status, const std::string& why, std::string allow = {}) {
  return {status, io::json_text({{"error", why}}), std::move(allow)};
}

}  // namespace stickslip::daemon
