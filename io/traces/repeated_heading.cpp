#include "io/traces/repeated_heading.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>

#include "io/traces/row_reader.hpp"
#include "io/traces/time_unit.hpp"

#include "core/base/wording.hpp"

namespace stickslip::traces {
namespace {

constexpr std::size_t kLongestCell = 40;

/// False only of texts that differ when folded, by their first byte; full-width digits count as no digits.
bool folds_alike(std::string_view one, std::string_view other) {
  if (one.empty() || other.empty()) return one.empty() == other.empty();
  const auto begins_number = [](char c) { return is_digit(c) || c == '-' || c == '+' || c == '.'; };
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c; };
  const auto is_ascii = [](char c) { return static_cast<unsigned char>(c) < 0x80U; };
  if (begins_number(one.front()) != begins_number(other.front())) return false;
  return lower(one.front()) == lower(other.front()) || !is_ascii(one.front()) || !is_ascii(other.front());
}

}  // namespace

RepeatedHeading::RepeatedHeading(const Dialect& dialect) : dialect_(dialect) {
  for (const ColumnName& column : dialect.columns) folded_names_.push_back(folded(column.name));
}

RepeatedHeading::Again RepeatedHeading::again(const std::vector<std::string_view>& fields,
                                              std::span<const Cell> cells, bool below_heading) const {
  if (dialect_.header_line == 0) return Again::kNo;
  bool same = true;
  bool units = dialect_.units_line > 0;
  for (std::size_t c = 0; c < dialect_.columns.size() && (same || units); ++c) {
    const std::string_view text = c < fields.size() ? trimmed(fields[c]) : std::string_view{};
    // Nearly every row is told by the first byte.
    same = same && folds_alike(text, dialect_.columns[c].text) && is_same(column_name(text), c);
    units = units && (text.empty() || (is_unit(text) && is_same_unit(column_name("", text).unit, c)));
  }
  if (same) return Again::kHeading;
  // A row of scans may look like units, "1", and one of holes like a rule: right below a heading they are
  // none.
  const bool has_text =
      std::any_of(cells.begin(), cells.end(), [](const Cell& cell) { return cell.kind == CellKind::kText; });
  if (units && (below_heading || has_text)) return Again::kOnlyUnits;
  const auto is_it = [&fields](const std::vector<std::string>& row) {
    return std::equal(row.begin(), row.end(), fields.begin(), fields.end(),
                      [](const std::string& one, std::string_view other) { return one == trimmed(other); });
  };
  const bool is_again = below_heading && std::any_of(dialect_.rows_below_heading.begin(),
                                                     dialect_.rows_below_heading.end(), is_it);
  return is_again ? Again::kOnlyUnits : Again::kNo;
}

bool RepeatedHeading::is_same(const ColumnName& name, std::size_t column) const {
  if (column >= dialect_.columns.size()) return false;
  const ColumnName& own = dialect_.columns[column];
  if (name.text == own.text) return true;
  const std::string& form = folded_names_[column];
  return folded(name.name) == form &&
         (name.unit == column_name(own.text).unit || mean_the_same(name.unit, own.unit)) &&
         std::count(folded_names_.begin(), folded_names_.end(), form) == 1;
}

bool RepeatedHeading::is_same_unit(const std::string& unit, std::size_t column) const {
  return column < dialect_.columns.size() && mean_the_same(unit, dialect_.columns[column].unit);
}

std::string RepeatedHeading::change(const std::vector<std::string_view>& fields) const {
  // Between blanks a name may be several fields.
  if (dialect_.header_line == 0 ||
      (dialect_.separator == kBlanks && fields.size() != dialect_.columns.size()))
    return {};
  bool units = dialect_.units_line > 0;
  bool named = false;
  std::optional<std::size_t> other_name;
  std::optional<std::size_t> other_unit;
  for (std::size_t c = 0; c < fields.size(); ++c) {
    const std::string_view text = trimmed(fields[c]);
    if (read_cell(text, dialect_.decimal).kind == CellKind::kNumber) return {};
    units = units && (text.empty() || is_unit(text));
    const ColumnName name = column_name(text);
    named = named || std::any_of(dialect_.columns.begin(), dialect_.columns.end(), [&](const auto& column) {
              return !name.name.empty() && folded(column.name) == folded(name.name);
            });
    if (!other_name && !is_same(name, c)) other_name = c;
    if (!other_unit && !text.empty() && !is_same_unit(column_name("", text).unit, c)) other_unit = c;
  }
  const auto other = units ? other_unit : other_name;
  if (!(units || named) || !other) return {};
  const std::string before = *other >= dialect_.columns.size() ? std::string{}
                             : units                           ? dialect_.columns[*other].unit
                                                               : dialect_.columns[*other].text;
  return fmt::format("another {}, with '{}' in column {} where line {} has '{}'",
                     units ? "row of units" : "heading", base::one_line(fields[*other], kLongestCell),
                     *other + 1, units ? dialect_.units_line : dialect_.header_line,
                     base::one_line(before, kLongestCell));
}

}  // namespace stickslip::traces
