#include "daemon/runtime/notify.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <ctime>

namespace stickslip::runtime {
namespace {

/// Sends as sd_notify(), but does not block. sd_notify() blocks while the manager has ten unread messages
/// [unix(7)], and the main thread would take no command and no signal. \return false if it would have to
/// block.
bool send_at_once(const std::string& message) {
  const char* const named = std::getenv("NOTIFY_SOCKET");
  const std::string_view name = named == nullptr ? "" : named;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (name.empty() || name.size() >= sizeof address.sun_path) return true;
  std::ranges::copy(name, address.sun_path);
  if (name[0] == '@') address.sun_path[0] = '\0';  // An abstract name.
  const int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return true;
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
  // The cast is what the sockets interface asks for; Asio would need a loop of its own for each message.
  const ssize_t sent = ::sendto(socket, message.data(), message.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                                reinterpret_cast<const sockaddr*>(&address), size);
  const bool must_wait = sent < 0 && errno == EAGAIN;
  ::close(socket);
  return !must_wait;
}

}  // namespace

void Notify::ready() {
  if (is_ready_) return;
  is_ready_ = true;
  // It ends a daemon that it does not hear this from: worth to wait for. One that cannot be reached must not
  // stop the measurement: the result is not used.
  static_cast<void>(sd_notify(0, "READY=1"));
}

void Notify::status(std::string_view text) {
  if (text == last_status_) return;
  last_status_ = text;
  if (!send_at_once(fmt::format("STATUS={}", text))) last_status_.clear();
}

void Notify::reloading() {
  // The time is for managers that ask for it (Type=notify-reload).
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  const std::int64_t now_us = std::int64_t{now.tv_sec} * 1'000'000 + now.tv_nsec / 1000;
  is_ready_ = false;
  static_cast<void>(sd_notify(0, fmt::format("RELOADING=1\nMONOTONIC_USEC={}", now_us).c_str()));
}

void Notify::alive() { static_cast<void>(send_at_once("WATCHDOG=1")); }

std::chrono::microseconds Notify::watchdog_interval() {
  std::uint64_t interval_us = 0;
  const bool watches = sd_watchdog_enabled(0, &interval_us) > 0;
  return std::chrono::microseconds{watches ? interval_us : 0};
}

void Notify::stopping() { static_cast<void>(send_at_once("STOPPING=1")); }

}  // namespace stickslip::runtime
