/// \file
/// [fleet] of the configuration: the broker that this tester tells its state and its results.
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

/// "mqtt://host", "mqtts://host:8883", "mqtt://[::1]:1883"; without a port that of the scheme (1883, 8883).
/// \return what is wrong with it, without the text itself.
[[nodiscard]] base::Result<Broker> parse_broker(std::string_view url);

struct FleetSettings {
  Broker broker;
  std::string broker_url;  ///< As configured.
  std::string tester;      ///< What this tester is called: one level of the topics.
  std::string topic = "stickslip";
  std::string user;                     ///< Empty: nobody.
  std::filesystem::path password_file;  ///< Empty: no password.
  std::filesystem::path ca_file;        ///< Who vouches for the broker; empty: whom the system trusts.
  std::filesystem::path certificate_file;
  std::filesystem::path key_file;
  std::filesystem::path outbox = "outbox";
  std::size_t outbox_results = 1000;
  double health_period_s = 10.0;

  /// Topic of this tester's `what`.
  [[nodiscard]] std::string topic_of(std::string_view what) const;
};

/// \param folder  of the configuration. Nothing if no broker is named.
[[nodiscard]] std::optional<FleetSettings> read_fleet(base::Settings table,
                                                      const std::filesystem::path& folder);

/// What stands in the password file, without the end of its line; nothing if there is none. Errors: kUsage if
/// everybody may read the file or it holds no line, kFailure if it cannot be read. No message holds it.
[[nodiscard]] base::Result<std::optional<std::string>> read_password(const std::filesystem::path& file);

/// Whether all files that it names can be read. Errors: kUsage, kFailure.
[[nodiscard]] base::Result<void> check_files(const FleetSettings& settings);

}  // namespace stickslip::io
