/// \file
/// The live stream over a WebSocket. Messages from the client are ignored.
#pragma once

#include <memory>
#include <string_view>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.

#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include "daemon/control/connection.hpp"

namespace stickslip::control {

/// Refusal when kMostClients are connected: text of status 503, or reason of the WebSocket's close frame.
inline constexpr std::string_view kLiveIsFull =
    "24 clients read the live stream, and there is room for no more: close one, or try again later";
static_assert(daemon::LiveHub::kMostClients == 24);

/// Starts to serve the live stream; does not block. \param request  the one that asked for the upgrade.
void serve_live(AnySocket socket, boost::beast::http::request<boost::beast::http::string_body> request,
                std::shared_ptr<Service> service);

}  // namespace stickslip::control
