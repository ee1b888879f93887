#include "daemon/control/query.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include <boost/algorithm/string/classification.hpp>
#include <boost/algorithm/string/split.hpp>

#include "daemon/control/request_body.hpp"

namespace stickslip::control {

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
    if (!query.emplace(key, part.substr(std::min(equals + 1, part.size()))).second)
      return base::usage_error("{}: stands there twice; send it once", key);
  }
  return query;
}

}  // namespace stickslip::control
