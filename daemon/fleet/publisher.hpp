/// \file
/// The thread that talks to the broker. Nobody waits for it: what it is told goes into places of fixed size,
/// and what does not fit is counted.
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
    /// What this tester is when the broker hears no more of it; asked for each connection.
    std::function<std::string()> last_will;
    /// Results of a former program that its outbox does not hold, oldest first; asked once, and again for
    /// the next one, until there is none.
    std::function<std::optional<FleetResult>()> backlog;
    /// The link is another; called on the thread of this class, may not wait.
    std::function<void(const daemon::FleetState&)> changed;
    std::chrono::milliseconds first_retry{1000};  ///< Then twice as long each time, to half a minute.
  };

  /// \param outbox  as settings say.
  FleetPublisher(io::FleetSettings settings, Outbox outbox, World world);
  /// As stop().
  ~FleetPublisher();
  FleetPublisher(const FleetPublisher&) = delete;
  FleetPublisher& operator=(const FleetPublisher&) = delete;

  // Any thread; none of them waits for broker or disk.
  void tell_state(std::string payload);   ///< Retained; what was not sent yet is replaced.
  void tell_health(std::string payload);  ///< At most once; what was not sent yet is replaced.
  void tell_result(FleetResult result);   ///< At least once.
  [[nodiscard]] daemon::FleetState state() const;

  /// Tells the last state and what is left as far as two seconds allow, says goodbye, ends the thread.
  void stop(std::string last_state);

 private:
  using Time = std::chrono::steady_clock::time_point;

  void run();
  void take_backlog();
  /// One connection. \return whether the broker let it in.
  bool connect_once();
  /// Until the connection is over or all is said. Errors: why it ended.
  [[nodiscard]] base::Result<void> talk();
  [[nodiscard]] base::Result<void> send_due();
  void acknowledged(int message, const std::string& refusal);
  /// What others have told meanwhile.
  void take_news();
  void accept(FleetResult result);
  /// Until the socket or a teller wakes it. \return whether the socket is readable, writable.
  std::pair<bool, bool> wait(int socket, bool wants_write, std::chrono::milliseconds longest);
  void wake();
  void set_link(daemon::FleetState::Link link, const std::string& why);
  [[nodiscard]] bool stopping() const;
  [[nodiscard]] bool all_said() const;

  io::FleetSettings settings_;
  World world_;
  Outbox outbox_;
  record::Descriptor wake_;  ///< An eventfd.

  mutable std::mutex mutex_;  ///< Held for moves of texts.
  daemon::FleetState shown_;
  std::optional<std::string> news_state_;
  std::optional<std::string> news_health_;
  std::vector<FleetResult> news_results_;
  bool stopping_ = false;
  Time stop_at_;  ///< Once stopping.

  // Of the thread.
  std::string state_;
  bool state_due_ = false;
  std::optional<std::string> health_;
  std::unique_ptr<MqttConnection> connection_;
  bool connected_ = false;
  int short_lives_ = 0;                   ///< Connections in a row that ended soon.
  std::string refusal_;                   ///< Of a message, by the broker.
  std::optional<int> state_message_;      ///< Sent, not acknowledged.
  std::map<int, std::string> in_flight_;  ///< Results: message and id.
  std::thread thread_;
};

}  // namespace stickslip::fleet
