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
};

struct HttpReply {
  int status = 200;
  std::string body;   ///< JSON text.
  std::string allow;  ///< Methods allowed, for status 405; else empty.
};

/// Answers on the main thread; must not throw.
using HttpHandler = std::function<HttpReply(const HttpRequest&)>;

}  // namespace stickslip::daemon
