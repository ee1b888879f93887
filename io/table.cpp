#include "io/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <clocale>
#include <cmath>
#include <cwchar>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/base/contract.hpp"
#include "core/base/text.hpp"

namespace stickslip::io {
namespace {

bool is_nothing(const Table::Cell& cell) {
  const double* number = std::get_if<double>(&cell);
  return std::holds_alternative<std::monostate>(cell) || (number != nullptr && !std::isfinite(*number));
}

/// A cell that is not nothing. \param format  of a number that is not whole.
std::string number_or_text(const Table::Cell& cell, const std::string& format) {
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  if (const auto* whole = std::get_if<std::int64_t>(&cell)) return fmt::format("{}", *whole);
  return fmt::format(fmt::runtime("{:" + format + "}"), std::get<double>(cell));
}

std::string shown(const Table::Cell& cell, const Table::Column& column, bool colours_stay) {
  if (!is_nothing(cell)) return base::printable(number_or_text(cell, column.format), colours_stay);
  return column.align == Table::Align::kRight ? std::string{kAbsent} : std::string{};
}

std::string csv_of(const Table::Cell& cell) {
  if (is_nothing(cell)) return {};
  const auto* text = std::get_if<std::string>(&cell);
  return text ? base::csv_cell(*text) : number_or_text(cell, "");
}

nlohmann::ordered_json json_of(const Table::Cell& cell) {
  if (is_nothing(cell)) return nullptr;
  return std::visit(
      [](const auto& value) -> nlohmann::ordered_json {
        if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::monostate>) {
          return nullptr;
        } else {
          return value;
        }
      },
      cell);
}

}  // namespace

std::size_t display_width(std::string_view text) {
  // The widths are those of the C library, which has them for the locale of the thread alone.
  static const locale_t utf8 = ::newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr);
  const locale_t before = ::uselocale(utf8);
  std::size_t width = 0;
  while (!text.empty()) {
    if (const std::size_t size = base::colour_size(text); size > 0) {
      text.remove_prefix(size);
      continue;
    }
    std::mbstate_t state{};
    wchar_t character = 0;
    const std::size_t size = std::mbrtowc(&character, text.data(), text.size(), &state);
    const bool is_utf8 = size > 0 && size <= text.size();
    const int places = is_utf8 ? ::wcwidth(character) : 1;
    if (places > 0) width += static_cast<std::size_t>(places);
    text.remove_prefix(is_utf8 ? size : 1);
  }
  ::uselocale(before);
  return width;
}

Table::Table(std::vector<Column> columns) : columns_(std::move(columns)) {}

Table Table::list(const std::vector<std::size_t>& widths) {
  std::vector<Column> columns;
  for (const std::size_t width : widths)
    columns.push_back({.heading = "", .align = Align::kLeft, .width = width});
  return Table{std::move(columns)};
}

void Table::add(std::vector<Cell> cells) {
  STICKSLIP_EXPECTS(cells.size() <= columns_.size());
  rows_.push_back(std::move(cells));
}

std::string padded(std::string_view text, std::size_t width, Table::Align align) {
  const std::string blanks(width - std::min(width, display_width(text)), ' ');
  return align == Table::Align::kLeft ? std::string{text} + blanks : blanks + std::string{text};
}

std::string Table::text(bool colours_stay) const {
  std::vector<std::vector<std::string>> lines(rows_.size() + 1);
  std::vector<std::pair<Align, std::size_t>> places;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const Column& column = columns_[c];
    if (!column.heading) continue;
    const bool has_unit = !column.unit.empty() && column.unit != "1";
    lines[0].push_back(
        base::printable(has_unit ? fmt::format("{} ({})", *column.heading, column.unit) : *column.heading));
    std::size_t width = std::max(column.width, display_width(lines[0].back()));
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      if (c >= rows_[r].size()) continue;
      lines[r + 1].push_back(shown(rows_[r][c], column, colours_stay));
      if (column.align == Align::kRight || c + 1 < rows_[r].size())
        width = std::max(width, display_width(lines[r + 1].back()));
    }
    places.emplace_back(column.align, width);
  }
  std::string text;
  for (const std::vector<std::string>& line : lines) {
    std::string row;
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (i > 0) row += "  ";
      row += padded(line[i], places[i].second, places[i].first);
    }
    row.erase(row.find_last_not_of(' ') + 1);
    if (!row.empty() || &line != &lines.front()) text += row + '\n';
  }
  return text;
}

std::string Table::csv() const {
  std::string text;
  const auto add_line = [&](const auto& cell_of) {
    bool first = true;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      if (columns_[c].name.empty()) continue;
      if (!std::exchange(first, false)) text += ',';
      text += cell_of(c);
    }
    text += "\r\n";
  };
  add_line([&](std::size_t c) { return base::csv_cell(columns_[c].name); });
  for (const std::vector<Cell>& row : rows_)
    add_line([&](std::size_t c) { return c < row.size() ? csv_of(row[c]) : std::string{}; });
  return text;
}

nlohmann::ordered_json Table::json() const {
  auto all = nlohmann::ordered_json::array();
  for (const std::vector<Cell>& row : rows_) {
    auto& object = all.emplace_back(nlohmann::ordered_json::object());
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      if (columns_[c].name.empty()) continue;
      object[columns_[c].name] = c < row.size() ? json_of(row[c]) : nlohmann::ordered_json(nullptr);
    }
  }
  return all;
}

}  // namespace stickslip::io
