/// \file
/// How it is with the broker, for status and metrics.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace stickslip::daemon {

struct FleetState {
  enum class Link {
    kConnecting,
    kConnected,
    kWaiting,  ///< For the next try.
  };
  Link link = Link::kConnecting;
  std::string why;     ///< What was in the way the last time, for people; empty while connected.
  std::string broker;  ///< As configured.
  std::string tester;
  std::uint64_t outbox_count = 0;          ///< Results that the broker has not got.
  std::uint64_t sent_result_count = 0;     ///< That it has acknowledged, since the start of the program.
  std::uint64_t dropped_result_count = 0;  ///< That a full outbox had no room for.
  std::uint64_t unsaved_result_count = 0;  ///< That wait in memory alone, because the disk refused them.
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
