#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/table.hpp"
#include "io/traces/import.hpp"
#include "io/traces/own_table.hpp"
#include "io/traces/quantity_unit.hpp"
#include "io/traces/trace_table.hpp"

#include "core/base/shell_word.hpp"
#include "core/base/text.hpp"
#include "core/base/wording.hpp"

namespace stickslip::traces {
namespace {

using base::Result;

constexpr std::size_t kFirstValues = 3;

/// The column that is a force by its unit or its name, else the last one with numbers.
std::size_t likely_column(const Dialect& dialect) {
  std::size_t last = 0;
  for (std::size_t c = 0; c < dialect.columns.size(); ++c) {
    if (!dialect.numeric[c] || time_rank(dialect.columns[c]) > 0) continue;
    const std::string name = folded(dialect.columns[c].name);
    const auto unit = quantity_unit(dialect.columns[c].unit);
    const bool by_name = name.starts_with("force") || name.starts_with("kraft") || name.starts_with("load") ||
                         name.starts_with("friction") || name.starts_with("reibkraft") || name == "f";
    if (by_name || (unit && unit->quantity == daq::RawQuantity::kForce_N)) return c;
    last = c;
  }
  return last;
}

/// As the file is called, so is the record.
std::string output_option(const std::string& path) {
  return " -o " + base::shell_word(path.substr(0, path.rfind('.')) + ".h5");
}

/// A table of stickslip export says all itself.
std::string own_command(const std::string& path) {
  return "stickslip import " + base::shell_word(path) + output_option(path);
}

/// Words in capitals stand for what the file does not say: nothing is guessed that changes a number.
std::string command(const ImportRequest& request, const Dialect& dialect, const std::string& cell_unit) {
  const std::size_t column = likely_column(dialect);
  const ColumnName& name = dialect.columns[column];
  const std::string& own = cell_unit.empty() ? name.unit : cell_unit;
  std::string text =
      fmt::format("stickslip import {} --column {}", base::shell_word(request.path),
                  name.text.empty() ? std::to_string(column + 1) : base::shell_word(name.text));
  const auto unit = quantity_unit(own);
  if (own.empty() || !unit) text += " --unit UNIT";
  if (!time_column_of(dialect, column)) {
    text += dialect.header_line == 0 && column != 0 ? " --time-column 1 --time-unit UNIT" : " --rate HZ";
  }
  const bool counts = unit && unit->quantity == daq::RawQuantity::kCounts;
  if (counts) text += " --count-range LOWEST..HIGHEST --volts-per-count VOLTS";
  if (counts || (unit && unit->quantity == daq::RawQuantity::kVolts)) text += " --load-cell-gain GAIN";
  if (!unit || unit->quantity != daq::RawQuantity::kCoefficient) text += " --sled-mass MASS";
  return text + output_option(request.path);
}

}  // namespace

Result<std::string> inspect(const ImportRequest& request) {
  const auto source = Source::of(request.path);
  if (!source) return tl::unexpected(source.error());
  const auto is_own = is_own_table(*source);
  if (!is_own) return tl::unexpected(is_own.error());
  const auto dialect = recognise(*source, request.dialect);
  if (!dialect) return tl::unexpected(dialect.error());
  using Column = io::Table::Column;
  constexpr auto kLeft = io::Table::Align::kLeft;
  io::Table columns{
      {Column{.heading = "column"}, Column{.heading = "name", .align = kLeft},
       Column{.heading = "unit", .align = kLeft}, Column{.heading = "first values", .align = kLeft},
       Column{.heading = "smallest", .format = ".6g"}, Column{.heading = "largest", .format = ".6g"}}};
  std::string likely_unit;
  for (std::size_t c = 0; c < dialect->columns.size(); ++c) {
    std::string first;
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    std::string unit = dialect->columns[c].unit;
    if (dialect->numeric[c]) {
      const auto table = read_table(*source, *dialect, c, std::nullopt);
      if (!table) return tl::unexpected(table.error());
      for (std::size_t i = 0; i < table->value.size(); ++i) {
        if (i < kFirstValues) first += fmt::format("{}{:.6g}", i == 0 ? "" : ", ", table->value[i]);
        if (!std::isfinite(table->value[i])) continue;
        low = std::min(low, table->value[i]);
        high = std::max(high, table->value[i]);
      }
      if (!table->cell_unit.empty()) unit = table->cell_unit;
    } else {
      first = "no numbers";
    }
    if (c == likely_column(*dialect)) likely_unit = unit;
    columns.add({io::cell(c + 1), base::one_line(dialect->columns[c].text, 30), base::one_line(unit, 12),
                 first, low, high});
  }
  const std::string import = *is_own ? own_command(request.path) : command(request, *dialect, likely_unit);
  return dialect->text() + columns.text() + "to import: " + base::printable(import) + "\n";
}

}  // namespace stickslip::traces
