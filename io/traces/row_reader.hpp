/// \file
/// Fields of the rows of a table of text [RFC 4180, by libcsv].
#pragma once

#include <csv.h>

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stickslip::traces {

/// Separators: ',', ';', '\t', '|', kBlanks, kNoSeparator.
inline constexpr char kBlanks = ' ';        ///< Runs of blanks and tabs, with an arrow "->" in them or not.
inline constexpr char kNoSeparator = '\0';  ///< The whole line is one field.

/// How a message names a separator: "comma", "tab" …
[[nodiscard]] std::string_view separator_name(char separator) noexcept;

/// Takes lines, gives rows: a field in quotes may hold separators and line ends.
class RowReader {
 public:
  explicit RowReader(char separator);

  /// \return whether the row is complete; if not, a quote is open, and the row goes on with the next line.
  [[nodiscard]] bool add(std::string_view line);
  /// Of the row that is complete, without blanks at their ends; valid until the next add().
  [[nodiscard]] const std::vector<std::string_view>& fields() const noexcept { return fields_; }

 private:
  /// Fast path for a line without quotes between rows: the fields of line_; one that is empty for a blank
  /// line.
  void split();
  static void on_field(void* text, std::size_t size, void* self);
  static void on_row(int character, void* self);

  char separator_;
  std::unique_ptr<csv_parser, void (*)(csv_parser*)> parser_;
  std::string line_;
  std::string text_;  ///< Of the fields of a row with quotes, one behind the other.
  std::vector<std::pair<std::size_t, std::size_t>> places_;
  std::vector<std::string_view> fields_;
  bool complete_ = true;  ///< The next line begins a row.
};

}  // namespace stickslip::traces
