#include "daemon/notify.hpp"

#include <fmt/format.h>
#include <systemd/sd-daemon.h>

namespace stickslip::daemon {
namespace {

/// A manager that cannot be reached must not stop the measurement: the result is not used.
void send(const std::string& message) { static_cast<void>(sd_notify(0, message.c_str())); }

}  // namespace

void Notify::ready() {
  if (is_ready_) return;
  is_ready_ = true;
  send("READY=1");
}

void Notify::status(std::string_view text) {
  if (text == last_status_) return;
  last_status_ = text;
  send(fmt::format("STATUS={}", text));
}

void Notify::stopping() { send("STOPPING=1"); }

}  // namespace stickslip::daemon
