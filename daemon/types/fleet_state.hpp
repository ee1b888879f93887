/// \file
/// State of the connection to the broker, for status and metrics.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace stickslip::daemon {

struct FleetState {
  enum class Link {
    kConnecting,
    kConnected,
    kWaiting,  ///< Pausing before the next attempt to connect.
  };
  Link link = Link::kConnecting;
  std::string why;     ///< Why the last attempt or connection failed, as text; empty while connected.
  std::string broker;  ///< As configured.
  std::string tester;
  std::uint64_t outbox_count = 0;          ///< Results that the broker has not acknowledged.
  std::uint64_t sent_result_count = 0;     ///< Results acknowledged since the start of the program.
  std::uint64_t dropped_result_count = 0;  ///< Results dropped because the outbox was full.
  std::uint64_t unsaved_result_count = 0;  ///< Results held in memory only, because the disk refused them.
};

[[nodiscard]] constexpr std::string_view name(FleetState::Link link) noexcept {
  switch (link) {
    case FleetState::Link::kConnecting:
      break;
    case FleetState::Link::kConnected:
      return "connected";
    case FleetState::Link::kWaiting:
      return "waiting";
  }
  return "connecting";
}

}  // namespace stickslip::daemon
