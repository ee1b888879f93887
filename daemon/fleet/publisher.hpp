/// \file
/// The publisher's thread, which talks to the broker. Other threads do not wait for it: they put messages
/// into bounded buffers; results that do not fit are counted.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "io/fleet_settings.hpp"

#include "core/record/file.hpp"
#include "daemon/fleet/mqtt_connection.hpp"
#include "daemon/fleet/outbox.hpp"
#include "daemon/types/fleet_state.hpp"

namespace stickslip::fleet {

class FleetPublisher {
 public:
  struct World {
    /// Makes the MQTT will; called for each connection, on this object's thread.
    std::function<std::string()> last_will;
    /// Returns the next result that an earlier program did not put into the outbox, oldest first; nothing: no
    /// more. Called at the start, on this object's thread; may block.
    std::function<std::optional<FleetResult>()> backlog;
    /// Called on this object's thread when the state of the connection has changed; must not block.
    std::function<void(const daemon::FleetState&)> changed;
    /// Called on this object's thread with each message of the topic "facts", which is read if there is such
    /// a function; must not block.
    std::function<void(std::string)> facts = {};
    /// Called on this object's thread if the broker refuses that topic; must not block.
    std::function<void(const std::string& why)> no_facts = {};
    /// Pause before the second attempt to connect; it doubles up to 30 s.
    std::chrono::milliseconds first_retry{1000};
  };

  /// Starts the thread. \param outbox  opened as `settings` say.
  FleetPublisher(io::FleetSettings settings, Outbox outbox, World world);
  /// As stop().
  ~FleetPublisher();
  FleetPublisher(const FleetPublisher&) = delete;
  FleetPublisher& operator=(const FleetPublisher&) = delete;

  // Any thread. None of these blocks on broker or disk.
  void tell_state(std::string payload);   ///< Sends a retained message; replaces one not sent yet.
  void tell_health(std::string payload);  ///< Sends a message at most once; replaces one not sent yet.
  void tell_result(FleetResult result);   ///< Sends a message at least once, through the outbox.
  [[nodiscard]] daemon::FleetState state() const;

  /// Sends the last state and the waiting results, disconnects and ends the thread. Blocks until all is
  /// acknowledged, as a rule for at most 4 s; an attempt to connect that is under way, or a backlog being
  /// read, may add to it.
  void stop(std::string last_state);

 private:
  using Time = std::chrono::steady_clock::time_point;

  void run();
  void take_backlog();
  /// Makes one connection and serves it until it ends. \return true if the broker accepted it.
  bool connect_once();
  /// Serves the connection until it ends or, after stop(), all is sent. Errors: why it ended.
  [[nodiscard]] base::Result<void> talk();
  [[nodiscard]] base::Result<void> send_due();
  void acknowledged(int message, const std::string& refusal);
  /// Takes over the messages from other threads.
  void take_news();
  void accept(FleetResult result);
  /// Blocks until the socket is ready, wake() is called or the time is over. \return whether the socket is
  /// readable, writable.
  std::pair<bool, bool> wait(int socket, bool wants_write, std::chrono::milliseconds longest);
  void wake();
  void set_link(daemon::FleetState::Link link, const std::string& why);
  [[nodiscard]] bool stopping() const;
  [[nodiscard]] bool all_said() const;

  io::FleetSettings settings_;
  World world_;
  Outbox outbox_;
  record::Descriptor wake_;  ///< An eventfd.

  mutable std::mutex mutex_;  ///< Held only to move texts.
  daemon::FleetState shown_;
  std::optional<std::string> news_state_;
  std::optional<std::string> news_health_;
  std::vector<FleetResult> news_results_;
  bool stopping_ = false;
  Time stop_at_;  ///< Valid while stopping_.

  // The following belong to the thread.
  std::string state_;
  bool state_due_ = false;
  bool facts_due_ = false;  ///< The topic is to be subscribed to.
  std::optional<std::string> health_;
  std::unique_ptr<MqttConnection> connection_;
  bool connected_ = false;
  int short_lives_ = 0;               ///< Connections in a row that ended before kWholeLife.
  std::string refusal_;               ///< Why the broker refused a message; empty: it did not.
  std::optional<int> state_message_;  ///< Number of the state message sent and not acknowledged.
  /// Results sent and not acknowledged. Key: message number; value: id of the result.
  std::map<int, std::string> in_flight_;
  std::thread thread_;
};

}  // namespace stickslip::fleet
