/// \file
/// Distributes the frames of the live stream to its clients. Main thread.
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

/// Bounded queue of frames for one client. When it is full, the oldest frame is dropped and counted, so that
/// a slow client sees recent frames. The client is told by a frame "dropped".
class LiveQueue {
 public:
  /// Capacity, frames: three seconds at 20 frames/s.
  static constexpr std::size_t kMost = 64;

  /// Adds a frame. \return number of frames dropped: 0 or 1.
  std::size_t push(LiveFrame frame) {
    const bool full = frames_.size() == kMost;
    if (full) frames_.pop_front();
    dropped_ += full ? 1U : 0U;
    frames_.push_back(std::move(frame));
    return full ? 1U : 0U;
  }
  [[nodiscard]] bool empty() const noexcept { return frames_.empty(); }
  /// The next frame: {"type": "dropped"} if frames were dropped since the last such frame, else the oldest
  /// one. The queue must not be empty.
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
  /// Takes a frame; does not block. \return number of frames dropped.
  virtual std::size_t offer(const LiveFrame& frame) = 0;
  /// Tells the client that the stream has ended.
  virtual void close() = 0;
};

class LiveHub {
 public:
  static constexpr std::size_t kMostClients = 24;
  /// Frames that are kept: at 20 slips a second 17 s of scans, falls and cycles; the page draws 10 s.
  static constexpr std::size_t kMostKept = 1024;

  /// \param changed  called with the number of clients when it changes.
  explicit LiveHub(std::function<void(std::size_t)> changed = {}) : changed_(std::move(changed)) {}

  [[nodiscard]] bool has_room() const noexcept { return clients_.size() < kMostClients; }
  /// Adds a client, which must outlive its membership. \return false if kMostClients are there.
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
  /// Publishes a frame and keeps it for history().
  void publish_and_keep(const LiveFrame& frame) {
    if (kept_.size() == kMostKept) kept_.pop_front();
    kept_.push_back(frame);
    publish(frame);
  }
  /// The kept frames, oldest first, as one: {"type":"history","frames":[…]}.
  [[nodiscard]] LiveFrame history() const {
    std::string text = R"({"type":"history","frames":[)";
    for (const LiveFrame& frame : kept_) {
      if (text.back() != '[') text += ',';
      text += *frame;
    }
    return std::make_shared<const std::string>(text + "]}");
  }
  void close() {
    // Clients leave while they are closed, so a copy is iterated.
    for (LiveClient* client : std::set<LiveClient*>{clients_}) client->close();
  }
  [[nodiscard]] std::size_t client_count() const noexcept { return clients_.size(); }
  [[nodiscard]] std::uint64_t dropped_count() const noexcept { return dropped_; }

 private:
  std::function<void(std::size_t)> changed_;
  std::set<LiveClient*> clients_;
  std::deque<LiveFrame> kept_;
  std::uint64_t dropped_ = 0;
};

}  // namespace stickslip::daemon
