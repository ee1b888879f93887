#include "core/record/metadata.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include <boost/algorithm/string/trim.hpp>

#include "core/base/text.hpp"
#include "core/base/wording.hpp"

namespace stickslip::record {
namespace {

constexpr bool is_letter(char c) noexcept { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

constexpr bool may_be_in_key(char c) noexcept {
  return is_letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
}

constexpr std::array<KnownFact, 5> kKnownFacts{{
    // From the coldest to the hottest climate chamber.
    {"temperature", "temperature of the air", "degC", base::Dimension::kTemperature, -80.0, 200.0, "23 degC"},
    {"humidity", "relative humidity of the air", "1", base::Dimension::kDimensionless, 0.0, 1.0, "50 %"},
    {.key = "conditioning", .long_name = {}, .unit = {}, .example = {}},
    // Up to a week.
    {"contact_time", "time at rest under the sled before the pull", "s", base::Dimension::kTime, 0.0,
     604'800.0, "5 s"},
    {.key = kLot, .long_name = {}, .unit = {}, .example = {}},
}};

const KnownFact* known(std::string_view key) noexcept {
  const auto* const found = std::find_if(kKnownFacts.begin(), kKnownFacts.end(),
                                         [key](const KnownFact& fact) { return fact.key == key; });
  return found == kKnownFacts.end() ? nullptr : found;
}

}  // namespace

std::string metadata_refusal(std::string_view key, std::string_view value) {
  if (key.empty() || key.size() > kLongestMetadataKey || !is_letter(key.front()) ||
      !std::all_of(key.begin(), key.end(), may_be_in_key)) {
    return fmt::format(
        "key \"{}\": a letter, then letters, digits, '_', '-' and '.', at most {} in all, are needed",
        base::one_line(key, kLongestMetadataKey), kLongestMetadataKey);
  }
  if (value.empty()) return fmt::format("{}: the value is empty: state one, or leave out the key", key);
  if (const std::string refusal = base::name_refusal(value); !refusal.empty())
    return fmt::format("{}: {}", key, refusal);
  return {};
}

std::span<const KnownFact> known_facts() noexcept { return kKnownFacts; }

base::Result<double> fact_number(std::string_view key, std::string_view value) {
  const KnownFact* const fact = known(key);
  if (fact == nullptr || fact->unit.empty()) return base::usage_error("{}: has no number", key);
  const auto number = base::parse_quantity(value, fact->dimension);
  if (!number) return base::usage_error("{}: {}", key, number.error().message);
  if (!(*number >= fact->lowest && *number <= fact->highest)) {
    const bool is_ratio = fact->unit == "1";
    return base::usage_error("{}: \"{}\" is not within {} … {}{}{}; write it like \"{}\"", key,
                             base::one_line(value), fact->lowest, fact->highest, is_ratio ? "" : " ",
                             is_ratio ? "" : fact->unit, fact->example);
  }
  return *number;
}

std::string why_no_number(std::string_view key, std::string_view value) {
  const KnownFact* const fact = known(key);
  if (fact == nullptr || fact->unit.empty()) return {};
  const auto number = fact_number(key, value);
  return number ? std::string{} : number.error().message;
}

base::Result<void> set_fact(Metadata& metadata, std::string_view key, std::string_view value) {
  if (value.empty()) {
    if (const auto there = metadata.find(key); there != metadata.end()) metadata.erase(there);
    return {};
  }
  for (const std::string& refusal : {metadata_refusal(key, value), why_no_number(key, value)}) {
    if (!refusal.empty()) return base::usage_error("{}", refusal);
  }
  if (!metadata.contains(key) && metadata.size() >= kMostMetadata) {
    return base::usage_error("{} would be key {}, at most {} are allowed: leave out some", key,
                             metadata.size() + 1, kMostMetadata);
  }
  metadata.insert_or_assign(std::string{key}, std::string{value});
  return {};
}

Metadata merged(const Metadata& below, Metadata above) {
  for (const auto& [key, value] : below) {
    if (above.size() < kMostMetadata) above.emplace(key, value);
  }
  return above;
}

base::Result<std::pair<std::string, std::string>> split_fact(std::string_view pair) {
  const std::size_t mark = pair.find('=');
  if (mark == std::string_view::npos) {
    return base::usage_error("\"{}\" has no '=': give KEY=VALUE, such as \"humidity=52 %\"",
                             base::one_line(pair));
  }
  const auto trimmed = [](std::string_view text) {
    return boost::algorithm::trim_copy_if(std::string{text}, [](char c) { return c == ' ' || c == '\t'; });
  };
  return std::pair{trimmed(pair.substr(0, mark)), trimmed(pair.substr(mark + 1))};
}

base::Result<void> add_metadata(Metadata& metadata, std::string_view pair, std::string_view place) {
  const auto fact = split_fact(pair);
  if (!fact) return base::usage_error("{}: {}", place, fact.error().message);
  const auto& [key, value] = *fact;
  if (const std::string refusal = metadata_refusal(key, value); !refusal.empty())
    return base::usage_error("{}: {}", place, refusal);
  if (const auto there = metadata.find(key); there != metadata.end()) {
    return base::usage_error("{}: {} is \"{}\" already, and \"{}\" comes too: leave out one of them", place,
                             key, base::one_line(there->second), base::one_line(value));
  }
  if (metadata.size() >= kMostMetadata) {
    return base::usage_error("{}: {} would be key {}, at most {} are allowed: leave out some", place, key,
                             metadata.size() + 1, kMostMetadata);
  }
  metadata.emplace(key, value);
  return {};
}

}  // namespace stickslip::record
