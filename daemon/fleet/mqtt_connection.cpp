#include "daemon/fleet/mqtt_connection.hpp"

#include <mosquitto.h>
#include <mqtt_protocol.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace stickslip::fleet {
namespace {

/// MQTT keep-alive. The broker ends a connection that is silent for 1.5 times this.
constexpr int kKeepAlive_s = 15;

/// Reason codes of MQTT 5 from here on are refusals (section 2.4).
constexpr int kFirstRefusal = 0x80;

/// Initialises libmosquitto once: mosquitto_lib_init() is not thread-safe, a static variable is.
void initialise_library() {
  struct Library {
    Library() { mosquitto_lib_init(); }
    ~Library() { mosquitto_lib_cleanup(); }
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;
  };
  static const Library library;
}

class Properties {
 public:
  Properties() {
    mosquitto_property_add_byte(&list_, MQTT_PROP_PAYLOAD_FORMAT_INDICATOR, 1);  // UTF-8
    mosquitto_property_add_string(&list_, MQTT_PROP_CONTENT_TYPE, "application/json");
  }
  ~Properties() { mosquitto_property_free_all(&list_); }
  Properties(const Properties&) = delete;
  Properties& operator=(const Properties&) = delete;

  [[nodiscard]] const mosquitto_property* get() const noexcept { return list_; }
  void release() noexcept { list_ = nullptr; }

 private:
  mosquitto_property* list_ = nullptr;
};

const char* text_or_null(const std::filesystem::path& path) { return path.empty() ? nullptr : path.c_str(); }

std::string reason_of(int code) {
  if (code == MOSQ_ERR_ERRNO) return std::generic_category().message(errno);
  return code >= kFirstRefusal ? mosquitto_reason_string(code) : mosquitto_strerror(code);
}

}  // namespace

void MqttConnection::Free::operator()(mosquitto* client) const { mosquitto_destroy(client); }

MqttConnection::MqttConnection(Events events) : events_(std::move(events)) {}
MqttConnection::~MqttConnection() = default;

base::Result<std::unique_ptr<MqttConnection>> MqttConnection::open(const MqttTarget& target,
                                                                   const MqttMessage& will, Events events) {
  initialise_library();
  std::unique_ptr<MqttConnection> connection{new MqttConnection(std::move(events))};
  // A clean start: what was not acknowledged is sent again by the owner, no session has to be kept for that.
  connection->client_.reset(mosquitto_new(target.client.c_str(), true, connection.get()));
  if (!connection->client_) return base::failure("no MQTT client: {}", reason_of(MOSQ_ERR_ERRNO));
  connection->set_callbacks();
  if (auto done = connection->set_up(target, will); !done) return tl::unexpected(done.error());
  errno = 0;
  const int code =
      mosquitto_connect_async(connection->client_.get(), target.host.c_str(), target.port, kKeepAlive_s);
  if (auto done = connection->result_of(code); !done) return tl::unexpected(done.error());
  return connection;
}

base::Result<void> MqttConnection::set_up(const MqttTarget& target, const MqttMessage& will) {
  mosquitto* const client = client_.get();
  int code = mosquitto_int_option(client, MOSQ_OPT_PROTOCOL_VERSION, MQTT_PROTOCOL_V5);
  if (code == MOSQ_ERR_SUCCESS) code = mosquitto_int_option(client, MOSQ_OPT_TCP_NODELAY, 1);
  if (code == MOSQ_ERR_SUCCESS && !target.user.empty()) {
    code = mosquitto_username_pw_set(client, target.user.c_str(),
                                     target.password ? target.password->c_str() : nullptr);
  }
  if (code == MOSQ_ERR_SUCCESS && target.tls) {
    const char* const certificate = text_or_null(target.certificate_file);
    const char* const key = text_or_null(target.key_file);
    if (target.ca_file.empty()) code = mosquitto_int_option(client, MOSQ_OPT_TLS_USE_OS_CERTS, 1);
    if (code == MOSQ_ERR_SUCCESS && !(target.ca_file.empty() && target.certificate_file.empty())) {
      code = mosquitto_tls_set(client, text_or_null(target.ca_file), nullptr, certificate, key, nullptr);
    }
  }
  if (code == MOSQ_ERR_SUCCESS) {
    Properties properties;
    code = mosquitto_will_set_v5(client, will.topic.c_str(), static_cast<int>(will.payload.size()),
                                 will.payload.data(), will.quality, will.retained,
                                 const_cast<mosquitto_property*>(properties.get()));
    if (code == MOSQ_ERR_SUCCESS) properties.release();  // They are the library's now.
  }
  return result_of(code);
}

void MqttConnection::set_callbacks() {
  mosquitto* const client = client_.get();
  mosquitto_connect_v5_callback_set(client,
                                    [](mosquitto*, void* self, int code, int, const mosquitto_property*) {
                                      auto& connection = *static_cast<MqttConnection*>(self);
                                      if (code == 0) {
                                        connection.events_.connected();
                                      } else {
                                        connection.why_ = reason_of(code);
                                      }
                                    });
  mosquitto_disconnect_v5_callback_set(client,
                                       [](mosquitto*, void* self, int code, const mosquitto_property*) {
                                         auto& connection = *static_cast<MqttConnection*>(self);
                                         if (connection.why_.empty() && code >= kFirstRefusal)
                                           connection.why_ = reason_of(code);
                                       });
  mosquitto_publish_v5_callback_set(
      client, [](mosquitto*, void* self, int message, int code, const mosquitto_property*) {
        static_cast<MqttConnection*>(self)->events_.acknowledged(
            message, code >= kFirstRefusal ? reason_of(code) : std::string{});
      });
  mosquitto_message_v5_callback_set(
      client, [](mosquitto*, void* self, const mosquitto_message* message, const mosquitto_property*) {
        auto& connection = *static_cast<MqttConnection*>(self);
        if (message->retain || !connection.events_.told) return;
        connection.events_.told(message->payloadlen > 0
                                    ? std::string{static_cast<const char*>(message->payload),
                                                  static_cast<std::size_t>(message->payloadlen)}
                                    : std::string{});
      });
  mosquitto_subscribe_v5_callback_set(
      client, [](mosquitto*, void* self, int, int count, const int* granted, const mosquitto_property*) {
        auto& connection = *static_cast<MqttConnection*>(self);
        if (count > 0 && granted[0] >= kFirstRefusal && connection.events_.not_subscribed)
          connection.events_.not_subscribed(reason_of(granted[0]));
      });
  // What OpenSSL finds wrong is told nowhere else.
  mosquitto_log_callback_set(client, [](mosquitto*, void* self, int level, const char* text) {
    auto& connection = *static_cast<MqttConnection*>(self);
    if (level == MOSQ_LOG_ERR && connection.why_.empty()) connection.why_ = text;
  });
}

base::Result<void> MqttConnection::result_of(int code) {
  if (code == MOSQ_ERR_SUCCESS) return {};
  return base::failure("{}", why_.empty() ? reason_of(code) : why_);
}

int MqttConnection::socket() const { return mosquitto_socket(client_.get()); }

bool MqttConnection::wants_write() const { return !any_write_ || mosquitto_want_write(client_.get()); }

base::Result<void> MqttConnection::serve(bool readable, bool writable) {
  // The library looks at errno after calls that did not set it.
  errno = 0;
  int code = MOSQ_ERR_SUCCESS;
  if (readable) code = mosquitto_loop_read(client_.get(), 1);
  errno = code == MOSQ_ERR_SUCCESS ? 0 : errno;
  if (code == MOSQ_ERR_SUCCESS && writable) {
    any_write_ = true;
    code = mosquitto_loop_write(client_.get(), 1);
  }
  if (code == MOSQ_ERR_SUCCESS) code = mosquitto_loop_misc(client_.get());
  if (auto done = result_of(code); !done) return done;
  if (socket() < 0) return base::failure("{}", why_.empty() ? "the connection ended" : why_);
  return {};
}

base::Result<int> MqttConnection::publish(const MqttMessage& message) {
  const Properties properties;
  int number = 0;
  errno = 0;
  const int code = mosquitto_publish_v5(client_.get(), &number, message.topic.c_str(),
                                        static_cast<int>(message.payload.size()), message.payload.data(),
                                        message.quality, message.retained, properties.get());
  if (auto done = result_of(code); !done) return tl::unexpected(done.error());
  return number;
}

base::Result<void> MqttConnection::subscribe(const std::string& topic) {
  errno = 0;
  return result_of(mosquitto_subscribe_v5(client_.get(), nullptr, topic.c_str(), 1,
                                          MQTT_SUB_OPT_SEND_RETAIN_NEVER, nullptr));
}

void MqttConnection::goodbye() {
  mosquitto_disconnect_v5(client_.get(), MQTT_RC_NORMAL_DISCONNECTION, nullptr);
}

}  // namespace stickslip::fleet
