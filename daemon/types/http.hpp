/// \file
/// One request and one reply of the control interface, free of any library.
#pragma once

#include <functional>
#include <string>

namespace stickslip::daemon {

struct HttpRequest {
  std::string method;  ///< "GET".
  std::string target;  ///< "/v1/status".
  std::string body;
  std::string controller;       ///< Header Stickslip-Controller: who commands.
  std::string idempotency_key;  ///< Header Idempotency-Key.
  std::string peer = {};  ///< Who the system says it is, "uid 1000"; the same for all who have the token.
};

struct HttpReply {
  int status = 200;
  std::string body;   ///< JSON text, unless content_type says otherwise.
  std::string allow;  ///< Methods allowed, for status 405; else empty.
  std::string content_type = "application/json";
  bool replayed = false;  ///< The answer of then to a request that is repeated.
  /// Content-Security-Policy; empty: nothing but the daemon's own files.
  std::string content_policy = {};
};

using HttpAnswer = std::function<void(HttpReply)>;

/// Called on the main thread; answers there too, once, at once or later. Must not throw.
using HttpHandler = std::function<void(const HttpRequest&, HttpAnswer)>;

}  // namespace stickslip::daemon
