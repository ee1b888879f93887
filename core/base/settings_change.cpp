// Settings that are changed before they are read.

#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

#include "core/base/settings_document.hpp"
#include "core/base/text.hpp"
#include "core/base/wording.hpp"

namespace stickslip::base {

std::string Settings::Document::place_of(std::string_view path, const toml::node& value) const {
  for (std::string_view above = path; !above.empty();) {
    if (const auto set = origins.find(above); set != origins.end()) return set->second;
    const std::size_t dot = above.rfind('.');
    above = above.substr(0, dot == std::string_view::npos ? 0 : dot);
  }
  return fmt::format("{}:{}", name, value.source().begin.line);
}

Error Settings::Document::error_at(std::string_view place, std::string_view what) const {
  std::string message = fmt::format("{}: {}", place, what);
  if (!changes.empty() && std::find(changes.begin(), changes.end(), place) == changes.end()) {
    message += fmt::format(" (with {})", fmt::join(changes, " "));
  }
  return {ErrorKind::kUsage, std::move(message)};
}

namespace {

/// The names of a dotted path; none if one is empty.
std::vector<std::string> names_of(std::string_view path) {
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    if (end == begin) return {};
    names.emplace_back(path.substr(begin, end - begin));
    begin = end + 1;
  }
  return names;
}

/// One TOML value, with quotes or without where it cannot be anything else: 0.3, "60 s", 60 s.
toml::table value_of(std::string_view key, std::string_view text) {
  toml::table holder;
  try {
    const toml::table parsed = toml::parse(fmt::format("value = {}", text));
    // A line break could smuggle in another key.
    if (parsed.size() == 1) {
      holder.insert(key, *parsed.get("value"));
      return holder;
    }
  } catch (const toml::parse_error&) {
    // A text then.
  }
  holder.insert(key, std::string{text});
  return holder;
}

}  // namespace

Result<void> Settings::Document::changed(std::string_view origin) {
  std::ostringstream out;
  out << toml::toml_formatter{root};
  try {
    (void)toml::parse(out.str());
  } catch (const toml::parse_error& error) {
    return usage_error("{}: {}", origin, one_line(error.description(), kLongestParserMessage));
  }
  changes.emplace_back(origin);
  text =
      fmt::format("# {} with {}\n\n{}\n", one_line(name, kLargestFile), fmt::join(changes, " "), out.str());
  return {};
}

Result<void> Settings::set(std::string_view path, std::string_view value, std::string_view origin) {
  const std::string place = one_line(origin, kLongestParserMessage);
  for (const std::string_view said : {path, value}) {
    if (!is_utf8(said)) return usage_error("{}: {}", place, name_refusal(said));
  }
  const std::vector<std::string> names = names_of(path);
  if (names.empty()) return usage_error("{}: needs a key, such as paper.mu_s", place);
  toml::table* table = &document_->root;
  std::string way;
  for (auto name = names.begin(); name + 1 != names.end(); ++name) {
    way = joined_path(way, *name);
    if (!table->contains(*name)) {
      table->insert(*name, toml::table{});
      document_->origins[way] = place;
    }
    table = table->get(*name)->as_table();
    if (table == nullptr) return usage_error("{}: {} is no table", place, way);
  }
  const toml::table holder = value_of(names.back(), value);
  table->insert_or_assign(names.back(), *holder.get(names.back()));
  document_->origins[std::string{path}] = place;
  return document_->changed(place);
}

Result<void> Settings::remove(std::string_view path, std::string_view origin) {
  const std::string place = one_line(origin, kLongestParserMessage);
  const std::vector<std::string> names = names_of(path);
  toml::table* table = names.empty() ? nullptr : &document_->root;
  for (auto name = names.begin(); table != nullptr && name + 1 != names.end(); ++name) {
    toml::node* next = table->get(*name);
    table = next == nullptr ? nullptr : next->as_table();
  }
  if (table == nullptr || !table->contains(names.back())) {
    std::set<std::string, std::less<>> there;
    if (table != nullptr) {
      for (const auto& [key, value] : *table) there.emplace(key.str());
    }
    return usage_error("{}: {} is not there; {}", place, one_line(path),
                       spelling_hint(names.empty() ? path : std::string_view{names.back()}, there));
  }
  table->erase(names.back());
  const std::string below = fmt::format("{}.", path);
  for (auto set = document_->origins.begin(); set != document_->origins.end();) {
    const bool gone = set->first == path || set->first.compare(0, below.size(), below) == 0;
    set = gone ? document_->origins.erase(set) : std::next(set);
  }
  return document_->changed(place);
}

}  // namespace stickslip::base
