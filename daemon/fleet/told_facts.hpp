/// \file
/// Facts of tests that clients of the broker tell, such as {"temperature": "23 degC"}. Each fact holds for a
/// time, then it is forgotten.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "core/record/metadata.hpp"
#include "daemon/types/event_receiver.hpp"

namespace stickslip::fleet {

/// Main thread, unless stated otherwise.
class ToldFacts {
 public:
  using Changed = std::function<void(record::Metadata)>;

  /// \param topic  for messages. \param valid_s  so long a fact holds. \param changed  gets all facts that
  /// hold.
  ToldFacts(boost::asio::io_context& io, std::string topic, double valid_s, Changed changed,
            daemon::EventReceiver& events);

  /// Takes a message. Any thread; does not block. Messages that are too long or too many are refused.
  void tell(std::string payload);
  /// The broker refuses the topic. Any thread; does not block.
  void not_subscribed(const std::string& why);
  void stop() { timer_.cancel(); }

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Fact {
    std::string value;
    Time until;
  };

  void take_waiting();
  void take(const std::string& payload);
  void forget_old();
  void wait_for_the_oldest();
  void refuse(const std::string& why);
  [[nodiscard]] record::Metadata facts() const;

  boost::asio::io_context& io_;
  boost::asio::steady_timer timer_;  ///< Runs until the oldest fact ends.
  std::string topic_;
  std::chrono::duration<double> valid_;
  Changed changed_;
  daemon::EventReceiver& events_;
  std::map<std::string, Fact> facts_;
  std::set<std::string> refusals_;  ///< That were reported; few, so that a mad client fills no log.

  std::mutex mutex_;
  std::vector<std::string> waiting_;  ///< Messages on their way to the main thread.
};

}  // namespace stickslip::fleet
