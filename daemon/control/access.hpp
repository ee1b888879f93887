/// \file
/// Access control. The Unix socket relies on its file permissions. A TCP port can be reached by any program
/// of the machine and by any page in a browser: there Host and Origin must be the daemon's own, and all
/// requests but those for the page need the token. Cookies are not used, so that requests of foreign pages
/// carry no rights.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/types/http.hpp"

namespace stickslip::control {

/// Access rules of a listener.
struct AccessPolicy {
  bool open = true;                ///< True: every connection is permitted, as on the Unix socket.
  std::vector<std::string> hosts;  ///< Permitted values of Host: "127.0.0.1:8037" …
  std::string token;               ///< The token; not empty unless open.
};

/// Path and headers of a request that decide about access; empty if absent.
struct AccessRequest {
  std::string_view path;
  std::string_view host;
  std::string_view origin;
  std::string_view authorization;
  std::string_view protocols;  ///< Sec-WebSocket-Protocol.
};

/// Prefix of the token as a second WebSocket subprotocol, because a browser cannot set other headers of a
/// WebSocket.
inline constexpr std::string_view kTokenProtocol = "token.";
/// The subprotocol of the live stream.
inline constexpr std::string_view kLiveProtocol = "stickslip.v1";

/// True for paths that need no token: the live page and its files. The page asks the user for the token.
[[nodiscard]] bool is_page(std::string_view path) noexcept;

/// The refusal of a request, or nothing if it is permitted: 403 for a foreign Host or Origin, 401 without the
/// token.
[[nodiscard]] std::optional<daemon::HttpReply> access_refusal(const AccessPolicy& policy,
                                                              const AccessRequest& request);

}  // namespace stickslip::control
