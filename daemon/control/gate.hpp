/// \file
/// Who comes in? On the Unix socket its permissions tell. On TCP any program of the machine and any page of a
/// browser can knock: there the Host must be ours, an Origin must be ours, and all but the page itself wants
/// the token. There are no cookies, so that another page's request carries nothing.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/types/http.hpp"

namespace stickslip::control {

/// What a listener asks of its clients.
struct Door {
  bool open = true;                ///< The system let in whom it may: nothing more is asked.
  std::vector<std::string> hosts;  ///< "127.0.0.1:8037" …
  std::string token;               ///< Not empty unless open.
};

/// The headers that count here; empty where absent.
struct Knock {
  std::string_view path;
  std::string_view host;
  std::string_view origin;
  std::string_view authorization;
  std::string_view protocols;  ///< Sec-WebSocket-Protocol.
};

/// A browser cannot set headers of a WebSocket: the token comes as a second subprotocol with this prefix.
inline constexpr std::string_view kTokenProtocol = "token.";
/// The subprotocol of the live stream.
inline constexpr std::string_view kLiveProtocol = "stickslip.v1";

/// Paths that anybody who is at the door may read: the page, which asks for the token itself.
[[nodiscard]] bool is_page(std::string_view path) noexcept;

/// Why not, if not: 403 for a foreign Host or Origin, 401 without the token.
[[nodiscard]] std::optional<daemon::HttpReply> refuse_at(const Door& door, const Knock& knock);

}  // namespace stickslip::control
