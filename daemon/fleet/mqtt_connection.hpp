/// \file
/// One connection to an MQTT 5 broker, from its beginning to its end: libmosquitto without threads of its own
/// and without its queue. What is not acknowledged when the connection ends is its owner's to send again.
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
  std::string client;  ///< Unique at the broker: a second one of that name ends the first.
  std::string user;
  std::optional<std::string> password;
  std::filesystem::path ca_file;  ///< Empty: whom the system trusts.
  std::filesystem::path certificate_file;
  std::filesystem::path key_file;
};

/// Thread-bound. Nothing in it waits, but for looking up the name of the host in open().
class MqttConnection {
 public:
  struct Events {
    std::function<void()> connected;
    /// The broker has it; `refusal` is for people and empty if it took it.
    std::function<void(int message, const std::string& refusal)> acknowledged;
  };

  /// Begins to connect; events come from serve(). \param will  what the broker tells others if this ends
  /// without goodbye(). Errors: kFailure.
  [[nodiscard]] static base::Result<std::unique_ptr<MqttConnection>> open(const MqttTarget& target,
                                                                          const MqttMessage& will,
                                                                          Events events);
  ~MqttConnection();
  MqttConnection(const MqttConnection&) = delete;
  MqttConnection& operator=(const MqttConnection&) = delete;

  /// To poll(2) for; −1 if there is none.
  [[nodiscard]] int socket() const;
  [[nodiscard]] bool wants_write() const;
  /// What the socket is ready for is done, and what time asks for: at least once a second.
  /// Errors: kFailure, the connection is over.
  [[nodiscard]] base::Result<void> serve(bool readable, bool writable);
  /// \return the number under which it is acknowledged. Errors: kFailure, it was not sent.
  [[nodiscard]] base::Result<int> publish(const MqttMessage& message);
  /// Ends it in order: the will is not told. What serve() says then is of no interest.
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
  std::string why_;         ///< Said by broker or library, before the end.
  bool any_write_ = false;  ///< The socket is connected once it can be written to.
};

}  // namespace stickslip::fleet
