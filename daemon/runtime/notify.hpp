/// \file
/// Reports the daemon's state to the service manager [sd_notify(3)]. Without NOTIFY_SOCKET in the environment
/// every call does nothing.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace stickslip::runtime {

/// Thread-bound: the main thread.
class Notify {
 public:
  /// Sends READY=1, once; later calls do nothing. Blocks until the manager has room for it.
  void ready();
  /// Sends STATUS=TEXT if the text has changed. Does not block: drops the message if the manager has no room.
  void status(std::string_view text);
  /// Sends RELOADING=1; call ready() later. Blocks until the manager has room for it.
  void reloading();
  /// Sends WATCHDOG=1. Does not block.
  void alive();
  /// Interval in which alive() must be called again [sd_watchdog_enabled(3)]; 0: there is no watchdog.
  [[nodiscard]] static std::chrono::microseconds watchdog_interval();
  /// Sends STOPPING=1. Does not block.
  void stopping();

 private:
  bool is_ready_ = false;
  std::string last_status_;
};

}  // namespace stickslip::runtime
