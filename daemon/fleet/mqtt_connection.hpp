/// \file
/// A connection to an MQTT 5 broker, by libmosquitto without its threads and its queue. The owner must send
/// again what was not acknowledged when the connection ends.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/base/result.hpp"

struct mosquitto;

namespace stickslip::fleet {

struct MqttMessage {
  std::string topic;
  std::string payload;  ///< JSON.
  int quality = 1;      ///< 0: at most once; 1: at least once.
  bool retained = false;
};

struct MqttTarget {
  std::string host;
  std::uint16_t port = 0;
  bool tls = false;
  /// Client identifier. It must be unique at the broker: a second client of that name ends the connection of
  /// the first.
  std::string client;
  std::string user;
  std::optional<std::string> password;
  std::filesystem::path ca_file;  ///< Empty: the system's certificate authorities.
  std::filesystem::path certificate_file;
  std::filesystem::path key_file;
};

/// Thread-bound. No function blocks, except for open() while it looks up the host name.
class MqttConnection {
 public:
  struct Events {
    std::function<void()> connected;
    /// The broker has answered a message. \param refusal  its reason; empty: accepted.
    std::function<void(int message, const std::string& refusal)> acknowledged;
    /// A message of a topic that is subscribed to; none that the broker retained, since its age is unknown.
    std::function<void(std::string payload)> told = {};
    /// The broker refuses a subscription.
    std::function<void(const std::string& refusal)> not_subscribed = {};
  };

  /// Begins to connect. serve() calls the events. \param will  the broker publishes it if the connection ends
  /// without goodbye(). Errors: kFailure.
  [[nodiscard]] static base::Result<std::unique_ptr<MqttConnection>> open(const MqttTarget& target,
                                                                          const MqttMessage& will,
                                                                          Events events);
  ~MqttConnection();
  MqttConnection(const MqttConnection&) = delete;
  MqttConnection& operator=(const MqttConnection&) = delete;

  /// The socket, for poll(2); −1 if there is none.
  [[nodiscard]] int socket() const;
  /// True if poll(2) must wait for POLLOUT too.
  [[nodiscard]] bool wants_write() const;
  /// Reads and writes as the socket allows, and does the keep-alive. Call it when the socket is ready, and at
  /// least once a second. Errors: kFailure; the connection has ended.
  [[nodiscard]] base::Result<void> serve(bool readable, bool writable);
  /// Sends a message. \return its number in Events::acknowledged. Errors: kFailure; it was not sent.
  [[nodiscard]] base::Result<int> publish(const MqttMessage& message);
  /// Asks for the messages of a topic. Errors: kFailure; it was not asked.
  [[nodiscard]] base::Result<void> subscribe(const std::string& topic);
  /// Disconnects without the will being published. Ignore the result of serve() afterwards.
  void goodbye();

 private:
  explicit MqttConnection(Events events);
  [[nodiscard]] base::Result<void> set_up(const MqttTarget& target, const MqttMessage& will);
  [[nodiscard]] base::Result<void> result_of(int code);
  void set_callbacks();

  struct Free {
    void operator()(mosquitto* client) const;
  };
  Events events_;
  std::unique_ptr<mosquitto, Free> client_;
  std::string why_;         ///< Reason from broker or library for the end of the connection.
  bool any_write_ = false;  ///< The socket was writable once: it is connected.
};

}  // namespace stickslip::fleet
