#include "core/record/metadata.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/text.hpp"
#include "core/base/wording.hpp"

namespace stickslip::record {
namespace {

constexpr bool is_letter(char c) noexcept { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

constexpr bool may_be_in_key(char c) noexcept {
  return is_letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
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

base::Result<void> add_metadata(Metadata& metadata, std::string_view pair, std::string_view place) {
  const std::size_t mark = pair.find('=');
  if (mark == std::string_view::npos) {
    return base::usage_error("{}: \"{}\" has no '=': give KEY=VALUE, such as \"humidity=52 %\"", place,
                             base::one_line(pair));
  }
  const std::string_view key = pair.substr(0, mark);
  const std::string_view value = pair.substr(mark + 1);
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
