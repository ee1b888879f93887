#include "daemon/cli/json_words.hpp"

#include <fmt/format.h>

namespace stickslip::daemon {

std::string word(const nlohmann::ordered_json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "–";
}

std::string number(const nlohmann::ordered_json& json, const char* key, int decimals) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? fmt::format("{:.{}f}", found->get<double>(), decimals)
                                                   : "–";
}

}  // namespace stickslip::daemon
