/// \file
/// The live stream over a WebSocket. What the client says is not looked at.
#pragma once

#include <memory>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.

#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include "daemon/control/connection.hpp"

namespace stickslip::daemon {

/// \param request  the one that asked for the upgrade.
void serve_live(AnySocket socket, boost::beast::http::request<boost::beast::http::string_body> request,
                std::shared_ptr<Service> service);

}  // namespace stickslip::daemon
