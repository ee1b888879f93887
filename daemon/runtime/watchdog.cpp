#include "daemon/runtime/watchdog.hpp"

namespace stickslip::runtime {

PulseWatch::PulseWatch(std::vector<WatchedPart> parts) {
  for (WatchedPart& part : parts) parts_.push_back({std::move(part)});
}

const std::vector<std::string>& PulseWatch::look() {
  hanging_.clear();
  for (Watched& watched : parts_) {
    const Pulse now = watched.part.pulse();
    const bool moved = now.at_rest || now.count != std::exchange(watched.before, now.count);
    watched.looks_still = moved ? 0 : watched.looks_still + 1;
    if (watched.looks_still > watched.part.patience * kLooksPerInterval)
      hanging_.push_back(watched.part.name);
  }
  return hanging_;
}

Watchdog::Watchdog(boost::asio::io_context& io, std::chrono::microseconds interval,
                   std::vector<WatchedPart> parts, Told told)
    : timer_(io), interval_(interval), watch_(std::move(parts)), told_(std::move(told)) {}

void Watchdog::start() {
  if (interval_.count() == 0 || std::exchange(started_, true)) return;
  told_.feed();
  wait();
}

void Watchdog::wait() {
  timer_.expires_after(interval_ / PulseWatch::kLooksPerInterval);
  timer_.async_wait([this](boost::system::error_code error) {
    if (!error) look();
  });
}

void Watchdog::look() {
  const std::vector<std::string> before = watch_.hanging();
  const std::vector<std::string>& hanging = watch_.look();
  if (hanging != before) told_.hanging(hanging);
  if (hanging.empty()) told_.feed();
  wait();
}

}  // namespace stickslip::runtime
