/// \file
/// The daemon's HTTP server on one end of a pair of sockets, and raw bytes on the other.
#pragma once

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <string>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>

#include "core/base/contract.hpp"
#include "daemon/control/api.hpp"
#include "daemon/control/connection.hpp"
#include "daemon/page/site.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/unit/paper_bench.hpp"

namespace stickslip::fuzz {

class RawClient {
 public:
  explicit RawClient(control::AccessPolicy policy) {
    service_ = std::make_shared<control::Service>(
        control::Service{std::move(policy),
                         page::make_site(control::make_api(bench_, clock_, lease_), report::ChartLibrary{}),
                         &hub_,
                         {}});
    std::array<int, 2> ends{};
    STICKSLIP_EXPECTS(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends.data()) == 0);
    client_ = ends[0];
    control::AnySocket socket{io_};
    socket.assign({AF_UNIX, 0}, ends[1]);
    control::serve_connection(std::move(socket), service_);
  }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;
  /// When the client has gone, nothing of the connection may be left but its timers.
  ~RawClient() {
    ::close(client_);
    while (io_.poll() > 0) {
    }
    STICKSLIP_EXPECTS(hub_.client_count() == 0);
  }

  /// Sends all and reads all that comes back, as long as anything happens; nothing waits for time to pass.
  std::string send(std::span<const std::uint8_t> bytes) {
    std::string answer;
    while (true) {
      bool moved = io_.poll() > 0;
      if (!bytes.empty()) {
        const ssize_t sent = ::send(client_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent > 0) bytes = bytes.subspan(static_cast<std::size_t>(sent));
        moved = moved || sent > 0;
        if (sent < 0 && errno == EPIPE) bytes = {};
      }
      std::array<char, 65536> part;
      const ssize_t got = ::recv(client_, part.data(), part.size(), 0);
      if (got > 0) answer.append(part.data(), static_cast<std::size_t>(got));
      if (!moved && got <= 0) return answer;
    }
  }
  void say_no_more() { ::shutdown(client_, SHUT_WR); }
  [[nodiscard]] daemon::LiveHub& hub() noexcept { return hub_; }

 private:
  daemon::PaperBench bench_;
  test::ManualClock clock_;
  control::Lease lease_;
  daemon::LiveHub hub_;
  boost::asio::io_context io_{1};
  std::shared_ptr<control::Service> service_;
  int client_ = -1;
};

/// What a TCP port asks for.
inline control::AccessPolicy tcp_policy() {
  return {false, {"localhost:80"}, "0123456789abcdef0123456789abcdef"};
}

}  // namespace stickslip::fuzz
