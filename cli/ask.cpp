#include "cli/ask.hpp"

#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "core/base/wording.hpp"
#include "daemon/client/client.hpp"

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::chrono::milliseconds kTimeout{5000};
constexpr std::size_t kLongestWarning = 1000;

}  // namespace

void add_bench_options(CLI::App& command, BenchOptions& options, bool commands) {
  command.add_option("--socket", options.socket, "the daemon's control socket")
      ->capture_default_str()
      ->type_name("PATH");
  command.add_flag("--json", options.json, "JSON instead of text");
  if (commands) {
    command
        .add_option("--as", options.who,
                    "your name as controller; default: user@host. Others are refused for half a minute")
        ->type_name("NAME");
  }
}

std::string user_name() {
  const passwd* const user = ::getpwuid(::getuid());
  char host[256] = "";
  if (::gethostname(host, sizeof host - 1) != 0) host[0] = '\0';
  return fmt::format("{}@{}", user != nullptr ? user->pw_name : std::to_string(::getuid()), host)
      .substr(0, 64);
}

base::Result<Json> ask(const BenchOptions& options, daemon::HttpRequest request) {
  request.controller = options.who.empty() ? user_name() : options.who;
  const base::Result<daemon::HttpReply> reply = client::request(options.socket, request, kTimeout);
  if (!reply) return tl::unexpected(reply.error());
  if (!reply->warning.empty())
    fmt::print(stderr, "warning: {}\n", base::one_line(reply->warning, kLongestWarning));
  Json json = Json::parse(reply->body, nullptr, false);
  if (json.is_discarded()) return base::failure("{}: the answer is no JSON", options.socket);
  if (reply->status == 200) return json;
  const Json why = json.is_object() ? json.value("error", Json(reply->body)) : Json(reply->body);
  const std::string text = why.is_string() ? why.get<std::string>() : why.dump();
  if (reply->status == 400 || reply->status == 404) return base::usage_error("{}", text);
  return base::failure("refused: {}", text);
}

}  // namespace stickslip::cli
