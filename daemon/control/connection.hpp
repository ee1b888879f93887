/// \file
/// A connection of the control interface, over a Unix or a TCP socket. It serves requests until the client
/// closes it, or becomes a live stream at the request for one.
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.

#include <boost/asio/generic/stream_protocol.hpp>

#include "daemon/control/access.hpp"
#include "daemon/control/limits.hpp"
#include "daemon/types/http.hpp"
#include "daemon/types/live_hub.hpp"

namespace stickslip::control {

/// A connection whose client is not admitted yet (HttpLimits).
class Newcomer {
 public:
  virtual ~Newcomer() = default;
  /// Closes the connection, to make room for another one.
  virtual void turn_away() = 0;
};

/// What all connections of a listener share.
struct Service {
  AccessPolicy policy;
  daemon::HttpHandler handler;
  daemon::LiveHub* hub = nullptr;  ///< Null: no live stream. Outlives the connections.
  HttpLimits limits;
  std::size_t connection_count = 0;     ///< Connections of admitted clients.
  std::list<Newcomer*> newcomers = {};  ///< The one silent for longest comes first.
};

using AnySocket = boost::asio::generic::stream_protocol::socket;

/// Starts to serve a connection; does not block. The connection lives until the client closes it or is too
/// slow, or the io_context ends.
void serve_connection(AnySocket socket, std::shared_ptr<Service> service);

}  // namespace stickslip::control
