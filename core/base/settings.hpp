/// \file
/// Checked reading of TOML settings: each key is asked for once with its dimension, range and
/// default, and what is wrong becomes one line with its place.
///
///     Result<Settings> settings = Settings::load("tester.toml");
///     if (!settings) return tl::unexpected(settings.error());
///     Settings tester = settings->table("tester");
///     const double mass_kg = tester.quantity("sled_mass", Dimension::kMass, Limits::above(0.0));
///     const bool damped = tester.boolean("damped", true);           // optional, with default
///     if (Result<void> ok = settings->finish(); !ok) return tl::unexpected(ok.error());
///
/// A getter that fails remembers why and returns a harmless stand-in (the default, else zero), so
/// that a reader asks for everything in a row; values count only after finish() has said yes.
/// finish() refuses keys that nobody asked for.
///
/// A document can be changed before it is read, as by options of a command; errors about what was
/// changed then name the option instead of a line of the file:
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

/// Allowed range of a number, in SI units.
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

  /// Reads and parses a file. Usage error: unreadable, too long, no TOML (with file:line).
  [[nodiscard]] static Result<Settings> load(const std::filesystem::path& file);
  /// Parses text. \param name stands for the file in messages.
  [[nodiscard]] static Result<Settings> parse(std::string_view text, std::string_view name);

  /// Sets a key of the document, whatever table this is; tables on its way are made.
  /// \param path    dotted, no arrays. \param value  TOML; what is none is taken as a string.
  /// \param origin  stands for the place in messages, e.g. the option as typed.
  /// Usage error: empty name in the path, a value on the way, a text that is no UTF-8.
  [[nodiscard]] Result<void> set(std::string_view path, std::string_view value, std::string_view origin);
  /// Removes a key or table that must be there; else usage error with what is.
  [[nodiscard]] Result<void> remove(std::string_view path, std::string_view origin);

  /// Name given to load() or parse(), and the whole text: as it was read, or, once changed, the
  /// changed document written anew under a line that says what changed.
  [[nodiscard]] const std::string& source_name() const noexcept;
  [[nodiscard]] const std::string& source_text() const noexcept;

  /// Is the key there? Does not count as asking for it.
  [[nodiscard]] bool has(std::string_view key) const;

  /// A sub-table; where it is absent, an empty one (its required keys are then missing).
  [[nodiscard]] Settings table(std::string_view key);
  /// [[key]] tables in order; none if absent.
  [[nodiscard]] std::vector<Settings> tables(std::string_view key);

  /// A number in SI units, written as a string with unit, or bare if dimensionless.
  /// Without `fallback` the key is required.
  [[nodiscard]] double quantity(std::string_view key, Dimension dimension, Limits limits,
                                std::optional<double> fallback = std::nullopt);
  /// As quantity(), but the key may be absent.
  [[nodiscard]] std::optional<double> quantity_if_given(std::string_view key, Dimension dimension,
                                                        Limits limits);

  [[nodiscard]] bool boolean(std::string_view key, std::optional<bool> fallback = std::nullopt);
  [[nodiscard]] std::int64_t integer(std::string_view key, std::int64_t min, std::int64_t max,
                                     std::optional<std::int64_t> fallback = std::nullopt);
  [[nodiscard]] std::string text(std::string_view key,
                                 const std::optional<std::string>& fallback = std::nullopt);
  /// An array of strings.
  [[nodiscard]] std::vector<std::string> texts(
      std::string_view key, const std::optional<std::vector<std::string>>& fallback = std::nullopt);

  /// One of the names; returns what it stands for.
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

  /// Remembers that the value of `key` (or the absence of the key) is refused; for rules that
  /// single getters cannot know, such as S ≥ K. Ends like "must not be below mu_k = 0.3".
  void refuse(std::string_view key, std::string_view why);

  /// Of the whole document: success, or the most telling error: a wrong value, else an unknown
  /// key, else a missing one.
  [[nodiscard]] Result<void> finish() const;

  /// Dotted paths of all keys asked for so far in the whole document, sorted; "[]" follows the
  /// name of an array of tables.
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
