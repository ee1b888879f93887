/// \file
/// The live stream: passes frames from the processing thread to the clients on the main thread, through a
/// bounded queue, and adds a health frame once a second.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "daemon/live/feed.hpp"
#include "daemon/types/live_hub.hpp"

namespace stickslip::live {

class LiveStream {
 public:
  /// Most frames in the queue to the main thread: about six seconds. Further frames are dropped and counted.
  static constexpr int kMostOnTheWay = 128;
  /// Frames are made for so long after the last client has left: a page that is reloaded finds no gap in the
  /// history.
  static constexpr std::chrono::seconds kLinger{10};

  /// \param clock   clock of the board; outlives the stream.
  /// \param health  makes a health frame; called once a second on the main thread while there are clients.
  LiveStream(boost::asio::io_context& io, const base::Clock& clock, std::function<std::string()> health)
      : io_(io),
        timer_(io),
        linger_(io),
        health_(std::move(health)),
        hub_([this](std::size_t count) { listeners(count); }),
        feed_(clock, [this](std::string frame) { send(std::move(frame)); }) {}

  [[nodiscard]] LiveFeed& feed() noexcept { return feed_; }
  [[nodiscard]] daemon::LiveHub& hub() noexcept { return hub_; }
  [[nodiscard]] const daemon::LiveHub& hub() const noexcept { return hub_; }
  /// Frames dropped because the main thread was too slow. Any thread.
  [[nodiscard]] std::uint64_t lost_count() const noexcept { return lost_.load(std::memory_order_relaxed); }
  /// Ends the stream for all clients. Main thread.
  void close() {
    timer_.cancel();
    linger_.cancel();
    hub_.close();
  }

 private:
  void listeners(std::size_t count) {
    linger_.cancel();
    if (count > 0) {
      feed_.listeners(count);
    } else {
      linger_.expires_after(kLinger);
      linger_.async_wait([this](boost::system::error_code error) {
        if (!error) feed_.listeners(0);
      });
    }
    const bool ticks = std::exchange(ticks_, count > 0);
    if (!ticks && count > 0) tick();
  }
  void tick() {
    hub_.publish(std::make_shared<const std::string>(health_()));
    timer_.expires_after(std::chrono::seconds{1});
    timer_.async_wait([this](boost::system::error_code error) {
      if (!error && ticks_) tick();
    });
  }
  void send(std::string frame) {
    if (on_the_way_.fetch_add(1, std::memory_order_relaxed) >= kMostOnTheWay) {
      on_the_way_.fetch_sub(1, std::memory_order_relaxed);
      lost_.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    boost::asio::post(io_, [this, frame = std::make_shared<const std::string>(std::move(frame))] {
      on_the_way_.fetch_sub(1, std::memory_order_relaxed);
      hub_.publish_and_keep(frame);
    });
  }

  boost::asio::io_context& io_;
  boost::asio::steady_timer timer_;
  boost::asio::steady_timer linger_;
  std::function<std::string()> health_;
  daemon::LiveHub hub_;
  LiveFeed feed_;
  bool ticks_ = false;
  std::atomic<int> on_the_way_{0};
  std::atomic<std::uint64_t> lost_{0};
};

}  // namespace stickslip::live
