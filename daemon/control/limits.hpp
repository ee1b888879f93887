/// \file
/// Limits of the memory and time that clients of the control interface can use.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace stickslip::control {

/// Limits of a listener and of each of its connections. A client is admitted by its first permitted request;
/// over TCP requests for the page, which need no token, do not admit it.
struct HttpLimits {
  std::uint32_t header_size = 8 * 1024;                ///< Bytes of the header of a request.
  std::uint64_t body_size = std::uint64_t{64} * 1024;  ///< Bytes of the body of a request.
  /// For one request to arrive, and again for its reply to be sent.
  std::chrono::milliseconds time{10'000};
  /// Most simultaneous connections of admitted clients; a further one gets a refusal. Live streams count.
  std::size_t connections = 32;
  /// Most simultaneous connections of clients not admitted yet, which do not count as `connections`. When
  /// there are more, the one silent for longest is closed.
  std::size_t newcomers = 16;
  /// Replaces `time`, if shorter, until the client is admitted.
  std::chrono::milliseconds newcomer_time{1000};
  /// A client of the live stream is disconnected after this time without a sign of life.
  std::chrono::milliseconds live_idle{60'000};
  /// Pause before the next attempt when accepting fails for want of descriptors or memory.
  std::chrono::milliseconds accept_again{100};
};

}  // namespace stickslip::control
