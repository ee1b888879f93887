/// \file
/// Feeds the service manager's watchdog [WatchdogSec= of systemd.service(5)] while all threads of the daemon
/// make progress. If one hangs, the manager restarts the daemon; so it does if the main thread hangs, which
/// runs this timer.
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

/// Progress of a part of the daemon, a thread as a rule.
struct Pulse {
  std::uint64_t count = 0;  ///< Changes whenever the part makes progress.
  bool at_rest = false;     ///< The part is idle and need not make progress.
};

struct WatchedPart {
  std::string name;
  std::function<Pulse()> pulse;
  /// Watchdog intervals without progress after which the part counts as hanging; 0: one look.
  int patience = 0;
};

/// Detects parts that hang, by regular looks at their pulses.
class PulseWatch {
 public:
  /// Looks in each watchdog interval; several, so that one late look does no harm.
  static constexpr int kLooksPerInterval = 4;

  explicit PulseWatch(std::vector<WatchedPart> parts);

  /// Looks at all pulses. \return names of the parts that have made no progress for longer than their
  /// patience.
  [[nodiscard]] const std::vector<std::string>& look();
  /// Result of the latest look().
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
    /// Called with the hanging parts when they change; empty: none hangs.
    std::function<void(const std::vector<std::string>&)> hanging;
  };

  /// \param interval  that of the service manager; 0: there is no watchdog, and no look.
  Watchdog(boost::asio::io_context& io, std::chrono::microseconds interval, std::vector<WatchedPart> parts,
           Told told);
  /// Starts the looks. Call it when the daemon is ready.
  void start();
  /// Ends the looks.
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
