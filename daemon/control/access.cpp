#include "daemon/control/access.hpp"

#include <algorithm>

#include "daemon/types/reply.hpp"

namespace stickslip::control {
namespace {

/// Compares in constant time for texts of equal length.
bool same_secret(std::string_view a, std::string_view b) noexcept {
  if (a.size() != b.size()) return false;
  unsigned char difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference = static_cast<unsigned char>(
        difference | (static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i])));
  }
  return difference == 0;
}

bool has_token(const AccessRequest& request, const std::string& token) {
  constexpr std::string_view kBearer = "Bearer ";
  if (request.authorization.starts_with(kBearer))
    return same_secret(request.authorization.substr(kBearer.size()), token);
  for (std::string_view rest = request.protocols; !rest.empty();) {
    const std::size_t comma = rest.find(',');
    std::string_view one = rest.substr(0, comma);
    rest = comma == std::string_view::npos ? std::string_view{} : rest.substr(comma + 1);
    while (one.starts_with(' ')) one.remove_prefix(1);
    if (one.starts_with(kTokenProtocol)) return same_secret(one.substr(kTokenProtocol.size()), token);
  }
  return false;
}

}  // namespace

bool is_page(std::string_view path) noexcept { return path == "/" || path.starts_with("/page/"); }

std::optional<daemon::HttpReply> access_refusal(const AccessPolicy& policy, const AccessRequest& request) {
  if (policy.open) return std::nullopt;
  const auto ours = [&policy](std::string_view host) {
    return std::find(policy.hosts.begin(), policy.hosts.end(), host) != policy.hosts.end();
  };
  if (!ours(request.host)) return daemon::refusal(403, "the Host of this request is not this daemon's");
  constexpr std::string_view kScheme = "http://";
  if (!request.origin.empty() &&
      !(request.origin.starts_with(kScheme) && ours(request.origin.substr(kScheme.size())))) {
    return daemon::refusal(403, "the Origin of this request is another site");
  }
  if (is_page(request.path)) return std::nullopt;
  if (policy.token.empty() || !has_token(request, policy.token)) {
    return daemon::refusal(401,
                           "the token is missing or wrong: on the tester's computer `stickslip page` opens "
                           "the page with the right one, "
                           "and `stickslip page --print` shows it; programs send Authorization: Bearer "
                           "TOKEN, from the daemon's token file");
  }
  return std::nullopt;
}

}  // namespace stickslip::control
