/// \file
/// Hands each frame of the live stream to all who listen. Main thread.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <set>
#include <string>

namespace stickslip::daemon {

using LiveFrame = std::shared_ptr<const std::string>;

/// What waits for one client: bounded, and it counts what it dropped. The oldest frames go: a slow client is
/// to see what is now. A client that was left out is told so by a frame of its own.
class LiveQueue {
 public:
  /// At 20 frames a second: three seconds.
  static constexpr std::size_t kMost = 64;

  /// \return how many were dropped for it: 0 or 1.
  std::size_t push(LiveFrame frame) {
    const bool full = frames_.size() == kMost;
    if (full) frames_.pop_front();
    dropped_ += full ? 1U : 0U;
    frames_.push_back(std::move(frame));
    return full ? 1U : 0U;
  }
  [[nodiscard]] bool empty() const noexcept { return frames_.empty(); }
  /// Not when empty.
  [[nodiscard]] LiveFrame pop() {
    if (dropped_ != told_) {
      told_ = dropped_;
      return std::make_shared<const std::string>(
          fmt::format(R"({{"type":"dropped","frame_count":{}}})", dropped_));
    }
    LiveFrame frame = std::move(frames_.front());
    frames_.pop_front();
    return frame;
  }
  [[nodiscard]] std::uint64_t dropped_count() const noexcept { return dropped_; }

 private:
  std::deque<LiveFrame> frames_;
  std::uint64_t dropped_ = 0;
  std::uint64_t told_ = 0;
};

class LiveClient {
 public:
  virtual ~LiveClient() = default;
  /// Never waits. \return frames dropped.
  virtual std::size_t offer(const LiveFrame& frame) = 0;
  /// The stream is over.
  virtual void close() = 0;
};

class LiveHub {
 public:
  static constexpr std::size_t kMostClients = 24;

  /// \param changed  told how many listen.
  explicit LiveHub(std::function<void(std::size_t)> changed = {}) : changed_(std::move(changed)) {}

  [[nodiscard]] bool has_room() const noexcept { return clients_.size() < kMostClients; }
  /// \return false if there are too many.
  [[nodiscard]] bool join(LiveClient* client) {
    if (!has_room()) return false;
    clients_.insert(client);
    if (changed_) changed_(clients_.size());
    return true;
  }
  void leave(LiveClient* client) {
    if (clients_.erase(client) > 0 && changed_) changed_(clients_.size());
  }
  void publish(const LiveFrame& frame) {
    for (LiveClient* client : clients_) dropped_ += client->offer(frame);
  }
  void close() {
    // Each leaves while it is told.
    for (LiveClient* client : std::set<LiveClient*>{clients_}) client->close();
  }
  [[nodiscard]] std::size_t client_count() const noexcept { return clients_.size(); }
  [[nodiscard]] std::uint64_t dropped_count() const noexcept { return dropped_; }

 private:
  std::function<void(std::size_t)> changed_;
  std::set<LiveClient*> clients_;
  std::uint64_t dropped_ = 0;
};

}  // namespace stickslip::daemon
