#include "core/analysis/skipped_corrections.hpp"

#include <algorithm>

namespace stickslip::analysis {

SkippedCorrections either(const SkippedCorrections& one, const SkippedCorrections& other) noexcept {
  SkippedCorrections skipped = one;
  for (const CorrectionName& name : kCorrectionNames) skipped.*name.flag = one.*name.flag || other.*name.flag;
  return skipped;
}

std::string text_of(const SkippedCorrections& skipped) {
  std::string text;
  for (const CorrectionName& name : kCorrectionNames) {
    if (!(skipped.*name.flag)) continue;
    if (!text.empty()) text += ',';
    text += name.name;
  }
  return text;
}

std::optional<SkippedCorrections> skipped_from_text(std::string_view text) {
  SkippedCorrections skipped;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const std::string_view name = text.substr(0, comma);
    const auto known =
        std::find_if(kCorrectionNames.begin(), kCorrectionNames.end(),
                     [name](const CorrectionName& candidate) { return candidate.name == name; });
    if (known == kCorrectionNames.end()) return std::nullopt;
    skipped.*known->flag = true;
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return skipped;
}

}  // namespace stickslip::analysis
