/// \file
/// The service manager's watchdog [WatchdogSec= of systemd.service(5)] is fed while all parts of the daemon
/// move: a thread that hangs has the daemon started again. The main thread, whose timer this is, feeds
/// nothing while it hangs itself.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

namespace stickslip::runtime {

/// How far a part has come.
struct Pulse {
  std::uint64_t count = 0;  ///< Differs from the last one if it moved.
  bool at_rest = false;     ///< It need not move, for a reason that the state says.
};

struct WatchedPart {
  std::string name;
  std::function<Pulse()> pulse;
  /// Intervals of the watchdog for which it may stand still before it is said to hang.
  int patience = 0;
};

/// Which parts hang, by looking at them from time to time.
class PulseWatch {
 public:
  /// Looks in an interval of the watchdog: so one look that comes late does not count.
  static constexpr int kLooksPerInterval = 4;

  explicit PulseWatch(std::vector<WatchedPart> parts);

  /// \return names of the parts that did not move since the last look, or for as long as they may.
  [[nodiscard]] const std::vector<std::string>& look();
  /// As look() said last.
  [[nodiscard]] const std::vector<std::string>& hanging() const noexcept { return hanging_; }

 private:
  struct Watched {
    WatchedPart part;
    std::uint64_t before = 0;
    int looks_still = 0;  ///< In a row.
  };
  std::vector<Watched> parts_;
  std::vector<std::string> hanging_;
};

/// Thread-bound: the main thread.
class Watchdog {
 public:
  struct Told {
    std::function<void()> feed;
    /// What hangs has changed; nothing hangs if it is empty.
    std::function<void(const std::vector<std::string>&)> hanging;
  };

  /// \param interval  the service manager's; 0: it does not watch, and nothing is looked at.
  Watchdog(boost::asio::io_context& io, std::chrono::microseconds interval, std::vector<WatchedPart> parts,
           Told told);
  /// From now on; the daemon is ready.
  void start();
  /// No look from now on.
  void stop() { timer_.cancel(); }
  [[nodiscard]] const std::vector<std::string>& hanging() const noexcept { return watch_.hanging(); }

 private:
  void wait();
  void look();

  boost::asio::steady_timer timer_;
  std::chrono::microseconds interval_;
  PulseWatch watch_;
  Told told_;
  bool started_ = false;
};

}  // namespace stickslip::runtime
