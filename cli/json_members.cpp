#include "cli/json_members.hpp"

#include <fmt/format.h>

#include "io/results_json.hpp"
#include "io/uncertain.hpp"

#include "core/base/text.hpp"

namespace stickslip::cli {

std::string word(const nlohmann::ordered_json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? base::printable(found->get<std::string>()) : "–";
}

base::Result<std::string> body_of(const nlohmann::ordered_json& json) {
  for (const auto& [key, value] : json.items()) {
    for (const auto& text : {nlohmann::ordered_json(key), value}) {
      if (!text.is_string() || base::is_utf8(text.get_ref<const std::string&>())) continue;
      return base::usage_error("{}: {}", base::printable(key),
                               base::name_refusal(text.get_ref<const std::string&>()));
    }
  }
  return json.dump();
}

std::string number(const nlohmann::ordered_json& json, const char* key, int decimals) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? fmt::format("{:.{}f}", found->get<double>(), decimals)
                                                   : "–";
}

std::string coefficient(const nlohmann::ordered_json& results, const char* name) {
  constexpr int kDecimals = 4;
  return io::uncertain(io::estimate_in(results, name), kDecimals).text();
}

}  // namespace stickslip::cli
