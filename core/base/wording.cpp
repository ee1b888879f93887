#include "core/base/wording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <vector>

#include "core/base/text.hpp"

namespace stickslip::base {
namespace {

constexpr bool continues_a_sequence(char c) noexcept {
  return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

/// Levenshtein's distance.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

}  // namespace

std::string one_line(std::string_view text, std::size_t longest) {
  std::size_t end = std::min(text.size(), longest);
  while (end > 0 && end < text.size() && continues_a_sequence(text[end])) --end;
  std::string shown = printable(text.substr(0, end));
  if (end < text.size()) shown += "…";
  return shown;
}

std::string reason_of(const std::exception& error) {
  const std::string_view what{error.what()};
  return one_line(what, what.size());
}

std::string system_message(int error) { return std::generic_category().message(error); }

std::string spelling_hint(std::string_view word, const std::set<std::string, std::less<>>& known) {
  constexpr std::size_t kFarthestGuess = 3;
  std::string list;
  std::string_view nearest;
  std::size_t nearest_distance = kFarthestGuess + 1;
  for (const std::string& name : known) {
    list += (list.empty() ? "" : ", ") + name;
    if (const std::size_t distance = edit_distance(word.substr(0, 100), name); distance < nearest_distance) {
      nearest_distance = distance;
      nearest = name;
    }
  }
  if (!nearest.empty()) return fmt::format("did you mean {}? Known here: {}", nearest, list);
  return fmt::format("known here: {}", list);
}

}  // namespace stickslip::base
