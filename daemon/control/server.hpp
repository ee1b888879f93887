/// \file
/// The server of the control interface: HTTP with JSON, and a WebSocket. It listens on a Unix socket for the
/// command line and curl, and if configured on a loopback TCP port for the page.
///
///     curl --unix-socket /run/stickslip/control.sock http://localhost/v1/status
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>

#include "core/base/result.hpp"
#include "daemon/control/limits.hpp"
#include "daemon/types/http.hpp"
#include "daemon/types/live_hub.hpp"

namespace stickslip::control {

/// Thread-bound: the thread that runs the io_context.
class ControlServer {
 public:
  /// Listens at `socket` with mode 0660 (owner and group). A stale socket file is replaced. If the service
  /// manager listens there already, its socket is used, and its file stays at the end. Errors: kUsage if the
  /// path is too long for a socket or is another kind of file; kFailure if another process listens there or
  /// the system refuses.
  [[nodiscard]] static base::Result<std::unique_ptr<ControlServer>> listen(
      boost::asio::io_context& io, const std::filesystem::path& socket, daemon::HttpHandler handler,
      HttpLimits limits = {}, daemon::LiveHub* hub = nullptr);

  /// Listens at a TCP port of this machine.
  /// \param address  "127.0.0.1:8037", "[::1]:8037" or "localhost:8037"; port 0: any, see address().
  /// \param token    required for all requests but those for the page; not empty (contract).
  /// Errors: kUsage if the address is invalid or not loopback; kFailure if the system refuses.
  [[nodiscard]] static base::Result<std::unique_ptr<ControlServer>> listen_tcp(
      boost::asio::io_context& io, const std::string& address, const std::string& token,
      daemon::HttpHandler handler, HttpLimits limits = {}, daemon::LiveHub* hub = nullptr);

  /// Closes the listener and removes the socket file; connections end with the io_context.
  ~ControlServer();
  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;

  /// Where it listens: a path, or address and port.
  [[nodiscard]] const std::string& address() const noexcept { return address_; }

  /// Implementation; one for each kind of socket.
  class Listener {
   public:
    virtual ~Listener() = default;
    virtual void close() = 0;
  };

 private:
  ControlServer(std::shared_ptr<Listener> listener, std::string address);
  std::shared_ptr<Listener> listener_;
  std::string address_;
};

}  // namespace stickslip::control
