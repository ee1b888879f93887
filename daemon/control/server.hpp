/// \file
/// JSON over HTTP on a Unix socket: the door for the command line and for curl.
///
///     curl --unix-socket /run/stickslip/control.sock http://localhost/v1/status
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>

#include <boost/asio/io_context.hpp>

#include "core/base/result.hpp"
#include "daemon/control/http.hpp"

namespace stickslip::daemon {

/// Limits of one connection: nobody can make the daemon hold more or wait longer.
struct HttpLimits {
  std::uint32_t header_size = 8 * 1024;                ///< Bytes.
  std::uint64_t body_size = std::uint64_t{64} * 1024;  ///< Bytes.
  std::chrono::milliseconds time{10'000};  ///< For one request to arrive, and for its reply to leave.
  int connections = 32;                    ///< At once; further ones are closed.
};

/// Thread-bound: the thread that runs the io_context.
class ControlServer {
 public:
  /// Listens at `socket` with mode 0660 (owner and group). A socket file that nobody answers is
  /// left over and replaced.
  /// Errors: kUsage if the path is too long for a socket or is another kind of file; kFailure if
  /// another process listens there or the system refuses.
  [[nodiscard]] static base::Result<std::unique_ptr<ControlServer>> listen(
      boost::asio::io_context& io, const std::filesystem::path& socket, HttpHandler handler,
      HttpLimits limits = {});
  /// Closes the listener and removes the socket file; connections end with the io_context.
  ~ControlServer();
  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;

 private:
  class Impl;
  explicit ControlServer(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

}  // namespace stickslip::daemon
