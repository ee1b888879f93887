/// \file
/// Replies of the control interface with a body of JSON.
#pragma once

#include <string>
#include <utility>

#include "io/json_text.hpp"
#include <nlohmann/json.hpp>

#include "core/base/result.hpp"
#include "daemon/types/http.hpp"

namespace stickslip::daemon {

[[nodiscard]] inline HttpReply reply_of(const nlohmann::ordered_json& json) {
  return {200, io::json_text(json), {}};
}

/// {"error": why}. \param allow  the allowed methods, for status 405.
[[nodiscard]] inline HttpReply refusal(int status, const std::string& why, std::string allow = {}) {
  return {status, io::json_text({{"error", why}}), std::move(allow)};
}

/// The text that a child process made, or why there is none: 400 if the request is wrong, 503 if it is to be
/// asked for later, else 409.
[[nodiscard]] inline HttpReply reply_with(base::Result<std::string> text,
                                          const char* content_type = "application/json") {
  constexpr int kWrong = 400;
  constexpr int kConflict = 409;
  constexpr int kLater = 503;
  if (!text) {
    const base::ErrorKind kind = text.error().kind;
    return refusal(kind == base::ErrorKind::kBusy    ? kLater
                   : kind == base::ErrorKind::kUsage ? kWrong
                                                     : kConflict,
                   text.error().message);
  }
  HttpReply reply{200, *std::move(text), {}};
  reply.content_type = content_type;
  return reply;
}

}  // namespace stickslip::daemon
