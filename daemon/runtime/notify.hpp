/// \file
/// Tells the service manager how the daemon is [sd_notify(3)]. Without NOTIFY_SOCKET in the
/// environment every call does nothing.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace stickslip::runtime {

/// Thread-bound: the main thread.
class Notify {
 public:
  /// READY=1, once; later calls do nothing. Waits until the manager has room for it.
  void ready();
  /// STATUS=…; repeated texts are sent once. One that the manager has no room for is left out: never waits.
  void status(std::string_view text);
  /// RELOADING=1, to be followed by ready(). Waits until the manager has room for it.
  void reloading();
  /// WATCHDOG=1. Never waits.
  void alive();
  /// In which alive() is to be called again [sd_watchdog_enabled(3)]; 0: nobody watches.
  [[nodiscard]] static std::chrono::microseconds watchdog_interval();
  /// STOPPING=1. Never waits.
  void stopping();

 private:
  bool is_ready_ = false;
  std::string last_status_;
};

}  // namespace stickslip::runtime
