/// \file
/// What stands behind Settings; for its implementation only.
#pragma once

#include <fmt/format.h>
#include <toml++/toml.h>

#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/settings.hpp"

namespace stickslip::base {

inline constexpr std::size_t kLongestParserMessage = 200;

[[nodiscard]] inline std::string joined_path(std::string_view parent, std::string_view key) {
  return parent.empty() ? std::string{key} : fmt::format("{}.{}", parent, key);
}

/// What has been asked of one table, which may be absent from the text.
struct Settings::Node {
  const toml::table* table = nullptr;
  std::string path;        ///< Dotted, empty for the root.
  std::string known_path;  ///< As path, but "[]" instead of the number in an array of tables.
  std::string place;       ///< Of the table's header, or of what should hold it.
  std::set<std::string, std::less<>> asked;
  std::map<std::string, std::vector<Node*>, std::less<>> children;
};

struct Settings::Document {
  std::string name;
  std::string text;
  toml::table root;
  std::deque<Node> nodes;
  std::optional<Error> first_wrong;
  std::optional<Error> first_missing;
  /// Of values and tables that set() brought in, by path.
  std::map<std::string, std::string, std::less<>> origins;
  std::vector<std::string> changes;  ///< Origins of all changes, in order.

  /// Where the value stands in the text, or who set it.
  [[nodiscard]] std::string place_of(std::string_view path, const toml::node& value) const;
  void wrong(std::string_view place, std::string_view what) {
    if (!first_wrong) first_wrong = error_at(place, what);
  }
  void wrong(const Node& table, std::string_view key, const toml::node& value, std::string_view what) {
    wrong(place_of(joined_path(table.path, key), value), what);
  }
  void missing(std::string_view place, std::string_view what) {
    if (!first_missing) first_missing = error_at(place, what);
  }
  /// A fault in the file may come from a change elsewhere, so all are named.
  [[nodiscard]] Error error_at(std::string_view place, std::string_view what) const;
  [[nodiscard]] std::optional<Error> first_unknown(const Node& node) const;
  /// The root changed: `text` must be it. Usage error if it cannot be written.
  [[nodiscard]] Result<void> changed(std::string_view origin);
};

}  // namespace stickslip::base
