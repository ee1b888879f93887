#include "core/analysis/kept.hpp"

#include <algorithm>

namespace stickslip::analysis {

Kept either(const Kept& one, const Kept& other) noexcept {
  Kept kept = one;
  for (const KeptName& name : kKeptNames) kept.*name.flag = one.*name.flag || other.*name.flag;
  return kept;
}

std::string text_of(const Kept& kept) {
  std::string text;
  for (const KeptName& name : kKeptNames) {
    if (!(kept.*name.flag)) continue;
    if (!text.empty()) text += ',';
    text += name.name;
  }
  return text;
}

std::optional<Kept> kept_from_text(std::string_view text) {
  Kept kept;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const std::string_view name = text.substr(0, comma);
    const auto known = std::find_if(kKeptNames.begin(), kKeptNames.end(),
                                    [name](const KeptName& candidate) { return candidate.name == name; });
    if (known == kKeptNames.end()) return std::nullopt;
    kept.*known->flag = true;
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return kept;
}

}  // namespace stickslip::analysis
