/// \file
/// The table [fleet] of the configuration: the MQTT broker to which this tester sends its state and results.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.hpp"
#include "core/base/settings.hpp"

namespace stickslip::io {

struct Broker {
  std::string host;
  std::uint16_t port = 0;
  bool tls = false;

  bool operator==(const Broker&) const = default;
};

/// Reads a broker's address: "mqtt://host", "mqtts://host:8883", "mqtt://[::1]:1883". The default port is
/// 1883, with TLS 8883. Errors: kUsage; the message does not repeat `url`, which may hold a password.
[[nodiscard]] base::Result<Broker> parse_broker(std::string_view url);

struct FleetSettings {
  Broker broker;
  std::string broker_url;  ///< As configured.
  std::string tester;      ///< Name of this tester: one level of its topics.
  std::string topic = "stickslip";
  std::string user;                     ///< Empty: no user name.
  std::filesystem::path password_file;  ///< Empty: no password.
  std::filesystem::path ca_file;        ///< Certificate authorities of the broker; empty: the system's.
  std::filesystem::path certificate_file;
  std::filesystem::path key_file;
  std::filesystem::path outbox = "outbox";
  std::size_t outbox_results = 1000;
  double health_period_s = 10.0;
  /// Facts of the topic "facts" hold for so long; nullopt: the topic is not read.
  std::optional<double> facts_valid_s;

  /// The topic TOPIC/TESTER/`what`.
  [[nodiscard]] std::string topic_of(std::string_view what) const;
};

/// Reads the table. \param folder  of the configuration file. \return nothing if no broker is named.
[[nodiscard]] std::optional<FleetSettings> read_fleet(base::Settings table,
                                                      const std::filesystem::path& folder);

/// Reads the password, without its line end. \return nothing if `file` is empty. Errors: kUsage if others may
/// read or write the file or it holds no line, kFailure if it cannot be read. No error message contains the
/// password.
[[nodiscard]] base::Result<std::optional<std::string>> read_password(const std::filesystem::path& file);

/// Checks that all files named in the settings can be read. Errors: kUsage, kFailure.
[[nodiscard]] base::Result<void> check_files(const FleetSettings& settings);

}  // namespace stickslip::io
