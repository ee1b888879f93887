/// \file
/// Checked reading of TOML settings. A getter reads one key, with its dimension, range and default; an error
/// is one line with its place.
///
///     Result<Settings> settings = Settings::load("tester.toml");
///     if (!settings) return tl::unexpected(settings.error());
///     Settings tester = settings->table("tester");
///     const double mass_kg = tester.quantity("sled_mass", Dimension::kMass, Limits::above(0.0));
///     const bool damped = tester.boolean("damped", true);           // optional, with default
///     if (Result<void> ok = settings->finish(); !ok) return tl::unexpected(ok.error());
///
/// A getter that fails stores the reason and returns a substitute, which need not be in range, so that a
/// reader can call all getters in sequence. Values are valid only if finish() succeeds. finish() refuses keys
/// that were not read.
///
/// A document can be changed before it is read, for example by command-line options. Errors about a changed
/// value then name the option instead of a line of the file:
///
///     if (auto set = settings->set("paper.mu_s", "0.34", "--set paper.mu_s=0.34"); !set) …
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/quantity.hpp"
#include "core/base/result.hpp"

namespace stickslip::base {

/// Allowed range of a number, in SI units; max belongs to it.
struct Limits {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_allowed = true;  ///< False: the value must be above min.

  [[nodiscard]] static Limits any() { return {}; }
  [[nodiscard]] static Limits above(double min) {
    return {min, std::numeric_limits<double>::infinity(), false};
  }
  [[nodiscard]] static Limits at_least(double min) {
    return {min, std::numeric_limits<double>::infinity(), true};
  }
  [[nodiscard]] static Limits between(double min, double max) { return {min, max, true}; }
  [[nodiscard]] static Limits above_up_to(double min, double max) { return {min, max, false}; }

  [[nodiscard]] bool allow(double value) const noexcept {
    return (min_allowed ? value >= min : value > min) && value <= max;
  }
};

/// One table of a TOML document; copies are views of the same document. Not thread-safe.
class Settings {
 public:
  /// Longest file that is read, bytes.
  static constexpr std::size_t kLargestFile = 1 << 20;

  /// Reads and parses a file. Usage error: unreadable, too long, not UTF-8 or invalid TOML (with file:line).
  [[nodiscard]] static Result<Settings> load(const std::filesystem::path& file);
  /// Parses text. \param name stands for the file in messages. Usage error: not UTF-8, invalid TOML.
  [[nodiscard]] static Result<Settings> parse(std::string_view text, std::string_view name);

  /// Sets a key of the document; creates missing tables on the path. Call it before reading: a Settings that
  /// table() or tables() returned before does not see an added table, and dangles if its table is replaced.
  /// \param path    dotted from the document's root, whichever table this is; no arrays.
  /// \param value  TOML; text that is not TOML is taken as a string.
  /// \param origin  stands for the place in messages, e.g. the option as typed.
  /// Usage error: empty name in the path, a value on the path that is not a table, text that is not UTF-8, a
  /// document that can no longer be written. Discard the document after an error.
  [[nodiscard]] Result<void> set(std::string_view path, std::string_view value, std::string_view origin);
  /// Removes a key or table. Call it before reading: a Settings of a removed table dangles.
  /// \param path,origin  as of set().
  /// Usage error if it is absent (the message lists the keys present beside it), or if the document can no
  /// longer be written. Discard the document after an error.
  [[nodiscard]] Result<void> remove(std::string_view path, std::string_view origin);

  /// Path given to load(), or name given to parse().
  [[nodiscard]] const std::string& source_name() const noexcept;
  /// Text of the whole document: as read, or, after set() or remove(), written anew below a line that lists
  /// the changes.
  [[nodiscard]] const std::string& source_text() const noexcept;

  /// Whether this table has the key. Does not count as reading it.
  [[nodiscard]] bool has(std::string_view key) const;

  /// A sub-table. An absent one is empty: its required keys are missing. A value that is no table is an
  /// error, and also gives an empty one.
  [[nodiscard]] Settings table(std::string_view key);
  /// [[key]] tables in order; none if absent or []. Any other value that is no array of tables is an error,
  /// and gives none.
  [[nodiscard]] std::vector<Settings> tables(std::string_view key);

  /// A number in SI units, written as a string with unit; a dimensionless one may be bare. Must be finite.
  /// \param fallback  value of an absent key, SI, not checked. All getters require the key without it.
  [[nodiscard]] double quantity(std::string_view key, Dimension dimension, Limits limits,
                                std::optional<double> fallback = std::nullopt);
  /// As quantity(), but the key may be absent. Nullopt if it is absent or wrong.
  [[nodiscard]] std::optional<double> quantity_if_given(std::string_view key, Dimension dimension,
                                                        Limits limits);

  [[nodiscard]] bool boolean(std::string_view key, std::optional<bool> fallback = std::nullopt);
  /// An integer from min to max, both allowed.
  [[nodiscard]] std::int64_t integer(std::string_view key, std::int64_t min, std::int64_t max,
                                     std::optional<std::int64_t> fallback = std::nullopt);
  [[nodiscard]] std::string text(std::string_view key,
                                 const std::optional<std::string>& fallback = std::nullopt);
  /// An array of strings.
  [[nodiscard]] std::vector<std::string> texts(
      std::string_view key, const std::optional<std::vector<std::string>>& fallback = std::nullopt);

  /// Reads one of the names; returns its value.
  /// \param names  at least one. \param fallback  one of their values; another value counts as none.
  template <typename T>
  [[nodiscard]] T choice(std::string_view key, std::span<const std::pair<std::string_view, T>> names,
                         std::optional<T> fallback = std::nullopt) {
    std::vector<std::string_view> texts;
    std::optional<std::size_t> fallback_index;
    for (std::size_t i = 0; i < names.size(); ++i) {
      texts.push_back(names[i].first);
      if (fallback && names[i].second == *fallback) fallback_index = i;
    }
    return names[choice_index(key, texts, fallback_index)].second;
  }

  /// Reports the value or the absence of `key` as an error, for rules over several keys, such as S ≥ K.
  /// \param why  end of the message, such as "must not be below mu_k = 0.3".
  void refuse(std::string_view key, std::string_view why);

  /// Result for the whole document, after all keys were read: success, or the most important error, which is
  /// the first wrong value, else an unknown key, else the first missing one.
  [[nodiscard]] Result<void> finish() const;

  /// Dotted paths of the keys that were asked for so far in the whole document, present or not, without those
  /// of tables; sorted. "[]" follows the name of an array of tables.
  [[nodiscard]] std::vector<std::string> known_keys() const;

 private:
  struct Document;
  struct Node;

  Settings(std::shared_ptr<Document> document, Node* node);

  [[nodiscard]] std::size_t choice_index(std::string_view key, std::span<const std::string_view> names,
                                         std::optional<std::size_t> fallback);

  std::shared_ptr<Document> document_;
  Node* node_;  ///< Owned by the document.
};

}  // namespace stickslip::base
