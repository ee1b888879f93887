/// \file
/// A request and a reply of the control interface, independent of the HTTP library.
#pragma once

#include <functional>
#include <string>

namespace stickslip::daemon {

struct HttpRequest {
  std::string method;  ///< "GET".
  std::string target;  ///< "/v1/status".
  std::string body;
  std::string controller;       ///< Header Stickslip-Controller: name of the commanding client.
  std::string idempotency_key;  ///< Header Idempotency-Key.
  /// Identity of the client: "uid 1000" on the Unix socket, one text for all clients with the token.
  std::string peer = {};
};

struct HttpReply {
  int status = 200;
  std::string body;   ///< JSON text, unless content_type says otherwise.
  std::string allow;  ///< Methods allowed, for status 405; else empty.
  std::string content_type = "application/json";
  /// This is the stored reply to an earlier request with the same Idempotency-Key.
  bool replayed = false;
  /// Header Content-Security-Policy; empty: the default, which allows the daemon's own files only.
  std::string content_policy = {};
  /// Header Stickslip-Warning: what the next version will refuse in such a request; empty: nothing.
  std::string warning = {};
};

using HttpAnswer = std::function<void(HttpReply)>;

/// Called on the main thread. It calls the HttpAnswer once, on the main thread, at once or later. It must not
/// throw.
using HttpHandler = std::function<void(const HttpRequest&, HttpAnswer)>;

}  // namespace stickslip::daemon
