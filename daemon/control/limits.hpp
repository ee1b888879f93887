/// \file
/// Nobody can make the daemon hold more or wait longer.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace stickslip::control {

/// Limits of one connection, and of a listener.
struct HttpLimits {
  std::uint32_t header_size = 8 * 1024;                ///< Bytes.
  std::uint64_t body_size = std::uint64_t{64} * 1024;  ///< Bytes.
  std::chrono::milliseconds time{10'000};  ///< For one request to arrive, and for its reply to leave.
  /// At once, of clients that were let in; a further one is told so. Live streams count as well.
  std::size_t connections = 32;
  /// Of clients that have not been let in yet: beside those that were, so that they take no room from them.
  /// The one that has been silent longest makes room for the next.
  std::size_t newcomers = 16;
  /// For the first request that is let in, if that is less than `time`.
  std::chrono::milliseconds newcomer_time{1000};
  /// A client of the live stream that gives no sign of life for so long is let go.
  std::chrono::milliseconds live_idle{60'000};
  /// When no connection can be taken (no file or no memory is left), until it is tried again.
  std::chrono::milliseconds accept_again{100};
};

}  // namespace stickslip::control
