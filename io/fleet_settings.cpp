#include "io/fleet_settings.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <system_error>
#include <utility>

#include "core/base/regular_file.hpp"

namespace stickslip::io {
namespace {

/// Default ports, IANA's of mqtt and secure-mqtt.
constexpr std::uint16_t kPlainPort = 1883;
constexpr std::uint16_t kTlsPort = 8883;

constexpr std::size_t kLongestTester = 64;
constexpr std::size_t kLongestTopic = 200;
constexpr std::size_t kMostOfPasswordFile = 4096;
constexpr std::int64_t kMostResults = 100'000;
constexpr double kShortestHealth_s = 1.0;
constexpr double kLongestHealth_s = 3600.0;
constexpr double kLongestFacts_s = 86'400.0;

bool is_word(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
           c == '_' || c == '.';
  });
}

/// True for a valid topic: levels of letters, digits, '-', '_' and '.' between single slashes. This excludes
/// wildcards and the broker's own topics ($…).
bool is_topic(std::string_view text) {
  while (true) {
    const std::size_t slash = text.find('/');
    if (!is_word(text.substr(0, slash))) return false;
    if (slash == std::string_view::npos) return true;
    text.remove_prefix(slash + 1);
  }
}

bool is_loopback(std::string_view host) {
  return host == "localhost" || host == "::1" || host.starts_with("127.");
}

std::string because() { return std::generic_category().message(errno); }

base::Result<void> check_readable(const char* key, const std::filesystem::path& file) {
  if (file.empty()) return {};
  if (const auto opened = base::open_regular(file); !opened)
    return base::usage_error("fleet.{}: {}", key, opened.error().message);
  return {};
}

}  // namespace

base::Result<Broker> parse_broker(std::string_view url) {
  constexpr const char* kAllowed =
      "must be mqtt://HOST, mqtts://HOST for TLS, or one of the two with :PORT after it";
  Broker broker;
  constexpr std::string_view kPlain = "mqtt://";
  constexpr std::string_view kTls = "mqtts://";
  if (url.starts_with(kTls)) {
    broker.tls = true;
    url.remove_prefix(kTls.size());
  } else if (url.starts_with(kPlain)) {
    url.remove_prefix(kPlain.size());
  } else {
    return base::usage_error("{}", kAllowed);
  }
  if (url.find('@') != std::string_view::npos) {
    return base::usage_error(
        "must not hold a name or a password: this text goes into every record; say "
        "user and password_file");
  }
  broker.port = broker.tls ? kTlsPort : kPlainPort;
  std::string_view rest;
  if (url.starts_with('[')) {
    const std::size_t end = url.find(']');
    if (end == std::string_view::npos) return base::usage_error("{}", kAllowed);
    broker.host = url.substr(1, end - 1);
    rest = url.substr(end + 1);
  } else {
    const std::size_t colon = url.find(':');
    broker.host = url.substr(0, colon);
    rest = colon == std::string_view::npos ? std::string_view{} : url.substr(colon);
  }
  const bool is_host =
      !broker.host.empty() && std::all_of(broker.host.begin(), broker.host.end(), [](char c) {
        return c == ':' || is_word({&c, 1});
      });
  if (!is_host) return base::usage_error("{}", kAllowed);
  if (rest.empty()) return broker;
  const char* const end = rest.data() + rest.size();
  if (!rest.starts_with(':')) return base::usage_error("{}", kAllowed);
  const auto [stopped, bad] = std::from_chars(rest.data() + 1, end, broker.port);
  if (bad != std::errc{} || stopped != end || broker.port == 0) {
    return base::usage_error("the port must be a number from 1 to 65535");
  }
  return broker;
}

std::string FleetSettings::topic_of(std::string_view what) const {
  return fmt::format("{}/{}/{}", topic, tester, what);
}

std::optional<FleetSettings> read_fleet(base::Settings table, const std::filesystem::path& folder) {
  FleetSettings settings;
  const auto file = [&](const char* key) {
    const std::string name = table.text(key, "");
    return name.empty() ? std::filesystem::path{} : folder / name;
  };
  settings.broker_url = table.text("broker", "");
  settings.tester = table.text("tester", "");
  settings.topic = table.text("topic", settings.topic);
  settings.user = table.text("user", "");
  settings.password_file = file("password_file");
  settings.ca_file = file("ca_file");
  settings.certificate_file = file("certificate_file");
  settings.key_file = file("key_file");
  settings.outbox = table.text("outbox", settings.outbox.string());
  settings.outbox_results = static_cast<std::size_t>(
      table.integer("outbox_results", 1, kMostResults, static_cast<std::int64_t>(settings.outbox_results)));
  settings.health_period_s =
      table.quantity("health_period", base::Dimension::kTime,
                     base::Limits::between(kShortestHealth_s, kLongestHealth_s), settings.health_period_s);
  settings.facts_valid_s = table.quantity_if_given("facts_valid", base::Dimension::kTime,
                                                   base::Limits::above_up_to(0.0, kLongestFacts_s));
  if (!is_topic(settings.topic) || settings.topic.size() > kLongestTopic) {
    table.refuse("topic", fmt::format("must be words of letters, digits, - _ . with single slashes between "
                                      "them, at most {} bytes",
                                      kLongestTopic));
  }
  if (settings.outbox.empty()) table.refuse("outbox", "must name a folder");
  if (settings.broker_url.empty()) return std::nullopt;
  base::Result<Broker> broker = parse_broker(settings.broker_url);
  if (!broker) {
    table.refuse("broker", broker.error().message);
    return std::nullopt;
  }
  settings.broker = *std::move(broker);
  if (!is_word(settings.tester) || settings.tester.size() > kLongestTester) {
    table.refuse("tester", settings.tester.empty()
                               ? "is missing: what is this tester called among those at the broker?"
                               : fmt::format("must be 1 to {} letters, digits, - _ .", kLongestTester));
  }
  const Broker& to = settings.broker;
  if (!settings.password_file.empty() && settings.user.empty()) {
    table.refuse("user", "is missing: a password alone is nobody's");
  }
  if (!settings.password_file.empty() && !to.tls && !is_loopback(to.host)) {
    table.refuse("broker", "must be mqtts:// where a password is sent to another machine");
  }
  if (!to.tls && !(settings.ca_file.empty() && settings.certificate_file.empty())) {
    table.refuse("broker", "must be mqtts:// where certificates are named");
  }
  if (settings.certificate_file.empty() != settings.key_file.empty()) {
    table.refuse(settings.key_file.empty() ? "key_file" : "certificate_file",
                 "is missing: a certificate and its key go together");
  }
  return settings;
}

base::Result<std::optional<std::string>> read_password(const std::filesystem::path& file) {
  if (file.empty()) return std::nullopt;
  struct stat facts {};
  if (::stat(file.c_str(), &facts) != 0) {
    return base::failure("password file {}: cannot be read: {}", file.string(), because());
  }
  if ((facts.st_mode & (S_IROTH | S_IWOTH)) != 0) {
    return base::usage_error("password file {}: everybody may read or write it; chmod o-rw it",
                             file.string());
  }
  const base::Result<std::string> text = base::read_text(file, kMostOfPasswordFile);
  if (!text) return tl::unexpected(base::Error{text.error().kind, "password file " + text.error().message});
  const std::string password = text->substr(0, text->find('\n'));
  if (password.empty()) {
    return base::usage_error("password file {}: must hold the password in its first line", file.string());
  }
  return password;
}

base::Result<void> check_files(const FleetSettings& settings) {
  if (auto password = read_password(settings.password_file); !password)
    return tl::unexpected(password.error());
  for (const auto& [key, file] :
       {std::pair{"ca_file", &settings.ca_file}, std::pair{"certificate_file", &settings.certificate_file},
        std::pair{"key_file", &settings.key_file}}) {
    if (auto readable = check_readable(key, *file); !readable) return readable;
  }
  return {};
}

}  // namespace stickslip::io
