#include <nlohmann/json.hpp>

#include "daemon/cli/commands.hpp"
#include "daemon/control/client.hpp"

namespace stickslip::daemon {

base::Result<std::string> run_status(const std::string& socket) {
  constexpr std::chrono::milliseconds kTimeout{5000};
  const base::Result<HttpReply> reply = request(socket, {"GET", "/v1/status", {}, {}, {}}, kTimeout);
  if (!reply) return tl::unexpected(reply.error());
  if (reply->status != 200)
    return base::failure("{}: refused with {}: {}", socket, reply->status, reply->body);
  const auto json = nlohmann::ordered_json::parse(reply->body, nullptr, false);
  if (json.is_discarded()) return base::failure("{}: the answer is no JSON", socket);
  return json.dump(2) + "\n";
}

}  // namespace stickslip::daemon
