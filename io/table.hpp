/// \file
/// One table as text for people, as CSV and as JSON. The only place that pads columns.
///
///     Table table{{{.name = "file", .heading = "file", .align = Table::Align::kLeft},
///                  {.name = "mu_s", .heading = "S", .format = ".4f"}}};
///     table.add({file, io::cell(results.mu_s.value)});
///     text += table.text();
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace stickslip::io {

/// Stands in text for a number that is absent.
inline constexpr std::string_view kAbsent = "–";

/// Places of a terminal that a text takes: a wide character (紙) takes two, a combining one and a colour code
/// (base::colour_size()) none.
/// \param text  UTF-8; a byte that is none counts as one.
[[nodiscard]] std::size_t display_width(std::string_view text);

class Table {
 public:
  enum class Align { kLeft, kRight };

  struct Column {
    std::string name = {};                    ///< In CSV and JSON, as in the record; empty: it is not there.
    std::optional<std::string> heading = {};  ///< In text; absent: it is not there.
    std::string unit = {};                    ///< Stands behind the heading, unless it is "1".
    Align align = Align::kRight;
    std::string format = {};  ///< Of numbers in text, as fmt has it: ".4f"; empty: as in CSV.
    std::size_t width = 0;    ///< In text: at least so wide.
  };

  /// Nothing, a number, a whole number or a text. A number that is none (NaN) or infinite is nothing too.
  using Cell = std::variant<std::monostate, double, std::int64_t, std::string>;

  explicit Table(std::vector<Column> columns);

  /// For text alone: left-aligned columns without headings, at least so wide.
  [[nodiscard]] static Table list(const std::vector<std::size_t>& widths);

  /// A row. \param cells  at most one for each column. In text a row ends with its last cell, which runs over
  /// the columns behind it if its own is left-aligned; in CSV and JSON those columns hold nothing.
  void add(std::vector<Cell> cells);

  /// Headings, unless all are blank, and rows, each as one line that base::printable() would leave as it is;
  /// two blanks between columns, none at the end. Nothing is "–" in a column of Align::kRight, else blank.
  /// \param colours_stay  as for base::printable().
  [[nodiscard]] std::string text(bool colours_stay = false) const;
  /// As RFC 4180, with a line of names; texts as base::csv_cell(), numbers with the fewest digits that read
  /// back to the same, nothing as an empty cell.
  [[nodiscard]] std::string csv() const;
  /// An array with an object for each row; nothing is null.
  [[nodiscard]] nlohmann::ordered_json json() const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<Cell>> rows_;
};

/// For what does not become a cell by itself: an optional value, a count, a view of a text.
template <typename T>
[[nodiscard]] Table::Cell cell(const T& value) {
  if constexpr (std::is_integral_v<T>) {
    return static_cast<std::int64_t>(value);
  } else if constexpr (std::is_convertible_v<T, std::string_view>) {
    return std::string{value};
  } else {
    return value;
  }
}

template <typename T>
[[nodiscard]] Table::Cell cell(const std::optional<T>& value) {
  return value ? cell(*value) : Table::Cell{};
}

/// A text with blanks up to a width in places of a terminal. A longer one stays as it is.
[[nodiscard]] std::string padded(std::string_view text, std::size_t width,
                                 Table::Align align = Table::Align::kLeft);

}  // namespace stickslip::io
