#include "daemon/types/quantity_json.hpp"

#include <fmt/format.h>

#include <algorithm>

#include <boost/algorithm/string/replace.hpp>
#include <nlohmann/json.hpp>

namespace stickslip::daemon {
namespace {

using base::BareNumber;
using Json = nlohmann::ordered_json;

constexpr std::size_t kLongestWarning = 2000;

}  // namespace

std::string text_of(const Warnings& warnings) {
  std::string text;
  for (std::size_t i = 0; i < warnings.size(); ++i) {
    if (i > 0 && text.size() + warnings[i].size() > kLongestWarning)
      return text + fmt::format("; and {} more", warnings.size() - i);
    if (i > 0) text += "; ";
    text += warnings[i];
  }
  return text;
}

std::string key_with_unit(std::string_view key, base::Dimension dimension) {
  std::string unit{base::si_unit(dimension)};
  boost::algorithm::replace_all(unit, "/", "_per_");
  boost::algorithm::replace_all(unit, "^", "");
  return fmt::format("{}_{}", key, unit);
}

base::Result<double> quantity_of(std::string_view key, const Json& value, base::Dimension dimension,
                                 BareNumber bare, Warnings* warnings) {
  std::string text;
  if (value.is_number()) {
    text = value.dump();
  } else if (value.is_string()) {
    text = value.get<std::string>();
    if (bare != BareNumber::kOnlyZero) bare = BareNumber::kRefused;
  } else {
    return base::usage_error("{}: must be text with a unit such as \"1 {}\"", key, base::si_unit(dimension));
  }
  const auto entered = base::enter_quantity(text, dimension, bare);
  if (!entered) {
    return value.is_number() ? base::usage_error("{}: {}; or a number as \"{}\"", key,
                                                 entered.error().message, key_with_unit(key, dimension))
                             : base::usage_error("{}: {}", key, entered.error().message);
  }
  if (!entered->warning.empty() && warnings != nullptr) {
    const std::string begin = fmt::format("{}: ", key);
    if (std::none_of(warnings->begin(), warnings->end(),
                     [&](const std::string& warning) { return warning.starts_with(begin); }))
      warnings->push_back(begin + entered->warning);
  }
  return entered->value;
}

base::Result<std::optional<double>> quantity_at(const Json& object, std::string_view key,
                                                base::Dimension dimension, BareNumber bare,
                                                Warnings* warnings) {
  const std::string with_unit = key_with_unit(key, dimension);
  const auto as_text = object.find(key);
  const auto as_number = object.find(with_unit);
  const bool has_text = as_text != object.end() && !as_text->is_null();
  const bool has_number = as_number != object.end() && !as_number->is_null();
  if (has_text && has_number) return base::usage_error("{} and {}: give one of them", key, with_unit);
  if (!has_text && !has_number) return std::optional<double>{};
  if (has_number && !as_number->is_number()) {
    return base::usage_error("{}: must be a number; text with a unit stands under \"{}\"", with_unit, key);
  }
  const auto value = has_text ? quantity_of(key, *as_text, dimension, bare, warnings)
                              : quantity_of(with_unit, *as_number, dimension, BareNumber::kSi, nullptr);
  if (!value) return tl::unexpected(value.error());
  return std::optional<double>{*value};
}

base::Result<std::string> text_at(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_string())
    return base::usage_error("\"{}\" is missing, or is no text", key);
  return found->get<std::string>();
}

}  // namespace stickslip::daemon
