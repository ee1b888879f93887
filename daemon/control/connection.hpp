/// \file
/// One connection of the control interface, over either kind of socket: request, reply, and again while the
/// client keeps it; or the live stream from the request on that asks for it.
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.

#include <boost/asio/generic/stream_protocol.hpp>

#include "daemon/control/gate.hpp"
#include "daemon/control/limits.hpp"
#include "daemon/types/http.hpp"
#include "daemon/types/hub.hpp"

namespace stickslip::control {

/// A connection without a request that was let in.
class Newcomer {
 public:
  virtual ~Newcomer() = default;
  /// To make room for another.
  virtual void turn_away() = 0;
};

/// What all connections of a listener share.
struct Service {
  Door door;
  daemon::HttpHandler handler;
  daemon::LiveHub* hub = nullptr;  ///< Null: no live stream. Outlives the connections.
  HttpLimits limits;
  std::size_t connection_count = 0;     ///< Of clients that were let in.
  std::list<Newcomer*> newcomers = {};  ///< The one that has been silent longest comes first.
};

using AnySocket = boost::asio::generic::stream_protocol::socket;

/// Lives until the client goes, is too slow, or the io_context ends.
void serve_connection(AnySocket socket, std::shared_ptr<Service> service);

}  // namespace stickslip::control
