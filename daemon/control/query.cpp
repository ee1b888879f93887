#include "daemon/control/query.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <vector>

#include <boost/algorithm/string/classification.hpp>
#include <boost/algorithm/string/split.hpp>

#include "core/base/quantity.hpp"
#include "daemon/control/request_body.hpp"

namespace stickslip::control {
std::optional<std::string> decoded(std::string_view value) {
  std::string text;
  for (std::size_t at = 0; at < value.size(); ++at) {
    if (value[at] != '%') {
      text += value[at];
      continue;
    }
    const std::string_view digits = value.substr(at + 1, 2);
    unsigned char byte = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), byte, 16);
    if (digits.size() != 2 || error != std::errc{} || end != digits.data() + 2) return std::nullopt;
    text += static_cast<char>(byte);
    at += 2;
  }
  return text;
}

base::Result<Query> query_of(const std::string& target, std::initializer_list<std::string_view> keys) {
  Query query;
  const std::size_t mark = target.find('?');
  if (mark == std::string::npos || mark + 1 == target.size()) return query;
  std::vector<std::string> parts;
  boost::split(parts, target.substr(mark + 1), boost::is_any_of("&"));
  for (const std::string& part : parts) {
    const std::size_t equals = std::min(part.find('='), part.size());
    const std::string key = part.substr(0, equals);
    if (std::find(keys.begin(), keys.end(), key) == keys.end())
      return base::usage_error("{}: there is no such key; there is {}", printable(key),
                               fmt::join(keys, ", "));
    const std::optional<std::string> value =
        decoded(std::string_view{part}.substr(std::min(equals + 1, part.size())));
    if (!value)
      return base::usage_error("{}: two hexadecimal digits are needed after each %; %25 is a % itself",
                               printable(key));
    if (!query.emplace(key, *value).second)
      return base::usage_error("{}: stands there twice; send it once", key);
  }
  return query;
}

base::Result<std::size_t> count_in(const Query& query, const std::string& key, std::size_t usual,
                                   std::size_t most) {
  const auto asked = query.find(key);
  if (asked == query.end()) return usual;
  const base::Result<double> count = base::parse_number(asked->second);
  if (count && *count >= 1.0 && *count <= static_cast<double>(most) &&
      *count == static_cast<double>(static_cast<std::size_t>(*count)))
    return static_cast<std::size_t>(*count);
  return base::usage_error("{}: must be a whole number from 1 to {}, not {}", key, most,
                           printable(asked->second));
}

}  // namespace stickslip::control
