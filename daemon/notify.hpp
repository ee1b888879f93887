/// \file
/// Tells the service manager how the daemon is [sd_notify(3)]. Without NOTIFY_SOCKET in the
/// environment every call does nothing.
#pragma once

#include <string>
#include <string_view>

namespace stickslip::daemon {

/// Thread-bound: the main thread.
class Notify {
 public:
  /// READY=1, once; later calls do nothing. Waits until the manager has room for it.
  void ready();
  /// STATUS=…; repeated texts are sent once. One that the manager has no room for is left out: never waits.
  void status(std::string_view text);
  /// STOPPING=1. Never waits.
  void stopping();

 private:
  bool is_ready_ = false;
  std::string last_status_;
};

}  // namespace stickslip::daemon
