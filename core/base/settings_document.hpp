/// \file
/// Implementation of Settings; not for other includers.
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

/// Longest part shown of a message of the parser, or of an origin, bytes.
inline constexpr std::size_t kLongestParserMessage = 200;

[[nodiscard]] inline std::string joined_path(std::string_view parent, std::string_view key) {
  return parent.empty() ? std::string{key} : fmt::format("{}.{}", parent, key);
}

/// One table of the document, or the place of one that is absent or no table (`table` is null), with the keys
/// that were asked for: finish() refuses all others.
struct Settings::Node {
  const toml::table* table = nullptr;
  std::string path;        ///< Dotted, empty for the root.
  std::string known_path;  ///< As path, but "[]" instead of the number in an array of tables.
  std::string place;       ///< Place of the table's header, or of the table that should contain it.
  std::set<std::string, std::less<>> asked;
  std::map<std::string, std::vector<Node*>, std::less<>> children;
};

/// The document that all its Settings share.
struct Settings::Document {
  std::string name;
  std::string text;
  toml::table root;
  std::deque<Node> nodes;
  std::optional<Error> first_wrong;
  std::optional<Error> first_missing;
  /// Origins of the values and tables that set() added, by path.
  std::map<std::string, std::string, std::less<>> origins;
  std::vector<std::string> changes;  ///< Origins of the set() and remove() that succeeded, in order.

  /// "file:line" of the value, or the origin of the set() that wrote it or a table around it.
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
  /// Usage error at a place. Unless the place is itself a change, the message lists all changes, since one
  /// elsewhere may have caused the error.
  [[nodiscard]] Error error_at(std::string_view place, std::string_view what) const;
  [[nodiscard]] std::optional<Error> first_unknown(const Node& node) const;
  /// After a change of the root: adds the origin to `changes` and rewrites `text`. Usage error if the root
  /// cannot be written; both then stay as they are.
  [[nodiscard]] Result<void> changed(std::string_view origin);
};

}  // namespace stickslip::base
