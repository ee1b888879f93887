/// \file
/// Nobody can make the daemon hold more or wait longer.
#pragma once

#include <chrono>
#include <cstdint>

namespace stickslip::daemon {

/// Limits of one connection, and of a listener.
struct HttpLimits {
  std::uint32_t header_size = 8 * 1024;                ///< Bytes.
  std::uint64_t body_size = std::uint64_t{64} * 1024;  ///< Bytes.
  std::chrono::milliseconds time{10'000};  ///< For one request to arrive, and for its reply to leave.
  int connections = 32;                    ///< At once; further ones are closed. Live streams count as well.
  /// A client of the live stream that gives no sign of life for so long is let go.
  std::chrono::milliseconds live_idle{60'000};
  /// When no connection can be taken (no file or no memory is left), until it is tried again.
  std::chrono::milliseconds accept_again{100};
};

}  // namespace stickslip::daemon
