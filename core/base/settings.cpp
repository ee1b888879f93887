#include "core/base/settings.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "core/base/regular_file.hpp"
#include "core/base/settings_document.hpp"
#include "core/base/text.hpp"
#include "core/base/wording.hpp"

namespace stickslip::base {

namespace {

std::string presentable(const toml::node& node) {
  if (const auto* text = node.as_string()) return fmt::format("\"{}\"", one_line(text->get()));
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (node.is_table()) return "a table";
  if (node.is_array_of_tables()) return "an array of tables";
  std::ostringstream out;
  node.visit([&out](const auto& value) { out << value; });
  return one_line(out.str());
}

/// parse_quantity() names the text first; the place has named it already.
std::string_view without_value(std::string_view message, std::string_view text) {
  message.remove_prefix(std::min(message.size(), text.size() + std::string_view{"\"\""}.size()));
  const std::size_t rest = message.find_first_not_of(": ");
  return rest == std::string_view::npos ? std::string_view{} : message.substr(rest);
}

std::string allowed_range(const Limits& limits, Dimension dimension) {
  const bool below = std::isfinite(limits.min);
  const bool above = std::isfinite(limits.max);
  const std::string min = format_quantity(limits.min, dimension);
  const std::string max = format_quantity(limits.max, dimension);
  if (below && above) {
    return limits.min_allowed ? fmt::format("must be from {} to {}", min, max)
                              : fmt::format("must be above {} and at most {}", min, max);
  }
  if (below) return fmt::format("must be {} {}", limits.min_allowed ? "at least" : "above", min);
  if (above) return fmt::format("must be at most {}", max);
  return "must be a finite number";
}

}  // namespace

std::optional<Error> Settings::Document::first_unknown(const Node& node) const {
  if (node.table == nullptr) return std::nullopt;
  for (const auto& [key, value] : *node.table) {
    if (!node.asked.contains(key.str())) {
      const std::string path = joined_path(node.path, key.str());
      const std::string_view what = value.is_table() || value.is_array_of_tables() ? "table" : "key";
      return error_at(place_of(path, value),
                      fmt::format("{}: unknown {}; {}",
                                  what == "table" ? fmt::format("[{}]", path)
                                                  : fmt::format("{} = {}", path, presentable(value)),
                                  what, spelling_hint(key.str(), node.asked)));
    }
  }
  for (const auto& [key, children] : node.children) {
    for (const Node* child : children) {
      if (std::optional<Error> error = first_unknown(*child)) return error;
    }
  }
  return std::nullopt;
}

Settings::Settings(std::shared_ptr<Document> document, Node* node)
    : document_(std::move(document)), node_(node) {}

Result<Settings> Settings::load(const std::filesystem::path& file) {
  const Result<std::string> read = read_text(file, kLargestFile + 1);
  if (!read) return tl::unexpected(Error{ErrorKind::kUsage, read.error().message});
  const std::string& text = *read;
  if (text.size() > kLargestFile) {
    return usage_error("{}: is longer than {} bytes, too long for settings", file.string(), kLargestFile);
  }
  return parse(text, file.string());
}

Result<Settings> Settings::parse(std::string_view text, std::string_view name) {
  auto document = std::make_shared<Document>();
  document->name = name;
  if (!is_utf8(text)) {
    std::size_t line = 1;
    while (is_utf8(text.substr(0, text.find('\n'))) && text.find('\n') != text.npos) {
      text.remove_prefix(text.find('\n') + 1);
      ++line;
    }
    return usage_error("{}:{}: {}", name, line, name_refusal(text.substr(0, text.find('\n'))));
  }
  document->text = text;
  try {
    document->root = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    return usage_error("{}:{}: {}", name, error.source().begin.line,
                       one_line(error.description(), kLongestParserMessage));
  }
  Node& root = document->nodes.emplace_back();
  root.table = &document->root;
  root.place = fmt::format("{}:1", name);
  return Settings{std::move(document), &root};
}

const std::string& Settings::source_name() const noexcept { return document_->name; }
const std::string& Settings::source_text() const noexcept { return document_->text; }

bool Settings::has(std::string_view key) const {
  return node_->table != nullptr && node_->table->get(key) != nullptr;
}

namespace {

/// The value of `key`, noted as asked for; null if absent.
template <typename Node>
const toml::node* ask(Node& node, std::string_view key) {
  node.asked.emplace(key);
  return node.table == nullptr ? nullptr : node.table->get(key);
}

}  // namespace

Settings Settings::table(std::string_view key) {
  const toml::node* value = ask(*node_, key);
  auto& children = node_->children[std::string{key}];
  if (children.empty()) {
    Node& child = document_->nodes.emplace_back();
    child.path = joined_path(node_->path, key);
    child.known_path = joined_path(node_->known_path, key);
    child.place = value != nullptr ? document_->place_of(child.path, *value) : node_->place;
    child.table = value != nullptr ? value->as_table() : nullptr;
    if (value != nullptr && child.table == nullptr) {
      document_->wrong(child.place, fmt::format("{} = {}: must be a table, written as [{}]", child.path,
                                                presentable(*value), child.path));
    }
    children.push_back(&child);
  }
  return Settings{document_, children.front()};
}

std::vector<Settings> Settings::tables(std::string_view key) {
  const toml::node* value = ask(*node_, key);
  auto& children = node_->children[std::string{key}];
  if (children.empty() && value != nullptr) {
    const std::string path = joined_path(node_->path, key);
    const toml::array* array = value->as_array();
    if (array == nullptr || (!array->empty() && !array->is_array_of_tables())) {
      document_->wrong(*node_, key, *value,
                       fmt::format("{} = {}: must be an array of tables, written as [[{}]]", path,
                                   presentable(*value), path));
      return {};
    }
    std::size_t number = 0;
    for (const toml::node& element : *array) {
      Node& child = document_->nodes.emplace_back();
      child.table = element.as_table();
      child.path = fmt::format("{}[{}]", path, number++);
      child.known_path = joined_path(node_->known_path, key) + "[]";
      child.place = document_->place_of(path, element);
      children.push_back(&child);
    }
  }
  std::vector<Settings> views;
  for (Node* child : children) views.push_back(Settings{document_, child});
  return views;
}

double Settings::quantity(std::string_view key, Dimension dimension, Limits limits,
                          std::optional<double> fallback) {
  if (const std::optional<double> value = quantity_if_given(key, dimension, limits)) return *value;
  if (!fallback && !has(key)) {
    document_->missing(
        node_->place,
        fmt::format("{} is missing; it {}{}", joined_path(node_->path, key), allowed_range(limits, dimension),
                    dimension == Dimension::kDimensionless ? "" : ", written as a string with its unit"));
  }
  return fallback.value_or(0.0);
}

std::optional<double> Settings::quantity_if_given(std::string_view key, Dimension dimension, Limits limits) {
  const toml::node* node = ask(*node_, key);
  if (node == nullptr) return std::nullopt;
  const std::string place = fmt::format("{} = {}", joined_path(node_->path, key), presentable(*node));

  double value = 0.0;
  if (const auto* text = node->as_string()) {
    const Result<double> parsed = parse_quantity(text->get(), dimension);
    if (!parsed) {
      document_->wrong(*node_, key, *node,
                       fmt::format("{}: {}", place, without_value(parsed.error().message, text->get())));
      return std::nullopt;
    }
    value = *parsed;
  } else if (node->is_number()) {
    if (dimension != Dimension::kDimensionless) {
      document_->wrong(*node_, key, *node,
                       fmt::format("{}: {}", place, unit_needed(presentable(*node), dimension)));
      return std::nullopt;
    }
    value = node->value<double>().value_or(0.0);
  } else {
    document_->wrong(
        *node_, key, *node,
        fmt::format(
            "{}: must be a {}", place,
            dimension == Dimension::kDimensionless ? "number" : "string holding a number and its unit"));
    return std::nullopt;
  }
  // NaN is refused by the first half, an unlimited infinity by the second.
  if (!limits.allow(value) || !std::isfinite(value)) {
    document_->wrong(*node_, key, *node,
                     fmt::format("{}: {}", place,
                                 std::isfinite(value) ? allowed_range(limits, dimension) : "must be finite"));
    return std::nullopt;
  }
  return value;
}

namespace {

std::string missing_text(std::string_view parent, std::string_view key, std::string_view what) {
  return fmt::format("{} is missing; it must be {}", joined_path(parent, key), what);
}

std::string wrong_text(std::string_view parent, std::string_view key, const toml::node& node,
                       std::string_view what) {
  return fmt::format("{} = {}: must be {}", joined_path(parent, key), presentable(node), what);
}

}  // namespace

bool Settings::boolean(std::string_view key, std::optional<bool> fallback) {
  constexpr std::string_view kWhat = "true or false";
  const toml::node* node = ask(*node_, key);
  if (node == nullptr) {
    if (!fallback) document_->missing(node_->place, missing_text(node_->path, key, kWhat));
    return fallback.value_or(false);
  }
  if (const auto* value = node->as_boolean()) return value->get();
  document_->wrong(*node_, key, *node, wrong_text(node_->path, key, *node, kWhat));
  return fallback.value_or(false);
}

std::int64_t Settings::integer(std::string_view key, std::int64_t min, std::int64_t max,
                               std::optional<std::int64_t> fallback) {
  const std::string what = fmt::format("an integer from {} to {}", min, max);
  const toml::node* node = ask(*node_, key);
  if (node == nullptr) {
    if (!fallback) document_->missing(node_->place, missing_text(node_->path, key, what));
    return fallback.value_or(min);
  }
  if (const auto* value = node->as_integer();
      value != nullptr && value->get() >= min && value->get() <= max) {
    return value->get();
  }
  document_->wrong(*node_, key, *node, wrong_text(node_->path, key, *node, what));
  return fallback.value_or(min);
}

std::string Settings::text(std::string_view key, const std::optional<std::string>& fallback) {
  constexpr std::string_view kWhat = "a string";
  const toml::node* node = ask(*node_, key);
  if (node == nullptr) {
    if (!fallback) document_->missing(node_->place, missing_text(node_->path, key, kWhat));
    return fallback.value_or("");
  }
  if (const auto* value = node->as_string()) return value->get();
  document_->wrong(*node_, key, *node, wrong_text(node_->path, key, *node, kWhat));
  return fallback.value_or("");
}

std::vector<std::string> Settings::texts(std::string_view key,
                                         const std::optional<std::vector<std::string>>& fallback) {
  constexpr std::string_view kWhat = "a list of strings";
  const toml::node* node = ask(*node_, key);
  if (node == nullptr) {
    if (!fallback) document_->missing(node_->place, missing_text(node_->path, key, kWhat));
    return fallback.value_or(std::vector<std::string>{});
  }
  std::vector<std::string> values;
  if (const toml::array* array = node->as_array()) {
    for (const toml::node& element : *array) {
      const auto* value = element.as_string();
      if (value == nullptr) break;
      values.push_back(value->get());
    }
    if (values.size() == array->size()) return values;
  }
  document_->wrong(*node_, key, *node, wrong_text(node_->path, key, *node, kWhat));
  return {};
}

std::size_t Settings::choice_index(std::string_view key, std::span<const std::string_view> names,
                                   std::optional<std::size_t> fallback) {
  std::string what = "one of";
  for (const std::string_view name : names)
    what += fmt::format("{} \"{}\"", name == names.front() ? "" : ",", name);

  const toml::node* node = ask(*node_, key);
  if (node == nullptr) {
    if (!fallback) document_->missing(node_->place, missing_text(node_->path, key, what));
    return fallback.value_or(0);
  }
  if (const auto* value = node->as_string()) {
    const auto found = std::find(names.begin(), names.end(), std::string_view{value->get()});
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  }
  document_->wrong(*node_, key, *node, wrong_text(node_->path, key, *node, what));
  return fallback.value_or(0);
}

void Settings::refuse(std::string_view key, std::string_view why) {
  const std::string told = one_line(why, why.size());  // It may name a file, and a name may hold anything.
  const toml::node* node = node_->table == nullptr ? nullptr : node_->table->get(key);
  const std::string path = joined_path(node_->path, key);
  if (node == nullptr) {
    document_->missing(node_->place, fmt::format("{}: {}", path, told));
  } else {
    document_->wrong(*node_, key, *node, fmt::format("{} = {}: {}", path, presentable(*node), told));
  }
}

Result<void> Settings::finish() const {
  if (document_->first_wrong) return tl::unexpected(*document_->first_wrong);
  if (std::optional<Error> unknown = document_->first_unknown(document_->nodes.front())) {
    return tl::unexpected(std::move(*unknown));
  }
  if (document_->first_missing) return tl::unexpected(*document_->first_missing);
  return {};
}

std::vector<std::string> Settings::known_keys() const {
  std::set<std::string> keys;
  for (const Node& node : document_->nodes) {
    for (const std::string& key : node.asked) {
      if (!node.children.contains(key)) keys.insert(joined_path(node.known_path, key));
    }
  }
  return {keys.begin(), keys.end()};
}

}  // namespace stickslip::base
