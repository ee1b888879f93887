#include "io/traces/inspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "io/table.hpp"
#include "io/traces/number_file.hpp"
#include "io/traces/own_table.hpp"
#include "io/traces/quantity_unit.hpp"
#include "io/traces/time_unit.hpp"
#include "io/traces/trace_table.hpp"

#include "core/base/shell_word.hpp"
#include "core/base/text.hpp"
#include "core/base/wording.hpp"
#include "core/record/iso_time.hpp"

namespace stickslip::traces {
namespace {

using base::Result;

constexpr std::size_t kFirstValues = 3;

/// The column that is a force by its unit or its name, else the last one with numbers that are not all equal.
std::size_t likely_column(const Dialect& dialect) {
  std::size_t last = 0;
  bool any = false;
  for (std::size_t c = 0; c < dialect.columns.size(); ++c) {
    if (!dialect.numeric[c] || time_rank(dialect.columns[c]) > 0) continue;
    const std::string name = folded(dialect.columns[c].name);
    const auto unit = quantity_unit(dialect.columns[c].unit);
    const bool by_name = name.starts_with("force") || name.starts_with("kraft") || name.starts_with("load") ||
                         name.starts_with("friction") || name.starts_with("reibkraft") || name == "f";
    if (by_name || (unit && unit->quantity == daq::RawQuantity::kForce_N)) return c;
    if (dialect.numbers && dialect.numbers->size(c) < dialect.numbers->size(last)) continue;
    if (any && !dialect.constant.empty() && dialect.constant[c]) continue;
    any = true;
    last = c;
  }
  return last;
}

/// "12:00:00.01", of seconds in a day; with the date where there is one.
std::string moment(const TraceTable& table, double since_first_s) {
  const double time_s = table.first_time + since_first_s;
  if (const double epoch_s = static_cast<double>(table.date_s.value_or(0)) + time_s;
      table.date_s && std::abs(epoch_s) < kFarthestEpoch_s)
    return record::iso_time(*table.date_s * 1'000'000'000 + std::llround(1e9 * time_s));
  constexpr double kDay_s = 86'400.0;
  const double of_day_s = std::fmod(time_s, kDay_s);
  const auto minutes = static_cast<int>(of_day_s / 60.0);
  return fmt::format("{:02}:{:02}:{:0{}.{}f}", minutes / 60, minutes % 60, of_day_s - 60.0 * minutes,
                     table.time_decimals > 0 ? table.time_decimals + 3 : 2, std::max(table.time_decimals, 0));
}

/// First and last of a column of clock times.
std::string clock_range(const Source& source, const Dialect& dialect, std::size_t column) {
  const auto table = read_table(source, dialect, likely_column(dialect), column);
  if (!table || table->time.empty()) return "no numbers";
  return fmt::format("{} … {}", moment(*table, 0.0), moment(*table, table->time.back()));
}

/// As the file is called, so is the record.
std::string output_option(const std::string& path) {
  std::filesystem::path output{path};
  output.replace_extension(".h5");
  if (output == path) output.replace_filename(output.stem().string() + "-record.h5");
  return " -o " + base::shell_word(output.string());
}

/// A table of stickslip export says all itself.
std::string own_command(const std::string& path) {
  return "stickslip import " + base::shell_word(path) + output_option(path);
}

/// How an option names a column: by its heading, or by its number where another column has the same heading
/// or the heading cannot be typed.
std::string column_word(const Dialect& dialect, std::size_t column) {
  const std::string& heading = dialect.columns[column].text;
  const auto same = std::count_if(dialect.columns.begin(), dialect.columns.end(),
                                  [&](const ColumnName& other) { return other.text == heading; });
  const bool is_clear = !heading.empty() && same == 1 && base::printable(heading) == heading;
  return is_clear ? base::shell_word(heading) : std::to_string(column + 1);
}

/// What tells the times where no column is one by its name.
std::string time_options(const Dialect& dialect, std::size_t column) {
  if (time_column_of(dialect, column)) return {};
  const auto clock = std::find(dialect.clock.begin(), dialect.clock.end(), true);
  if (clock == dialect.clock.end())
    return !dialect.numbers && dialect.header_line == 0 && column != 0 ? "--time-column 1 --time-unit UNIT"
                                                                       : "--rate HZ";
  const auto at = static_cast<std::size_t>(clock - dialect.clock.begin());
  return "--time-column " + column_word(dialect, at);
}

/// Words in capitals stand for what the file does not say: nothing is guessed that changes a number.
std::string command(const ImportRequest& request, const Dialect& dialect, const std::string& cell_unit) {
  const std::size_t column = likely_column(dialect);
  const ColumnName& name = dialect.columns[column];
  const std::string& own = cell_unit.empty() ? name.unit : cell_unit;
  std::string text =
      fmt::format("stickslip import {} {} {}", base::shell_word(request.path),
                  dialect.numbers ? dialect.numbers->option() : "--column", column_word(dialect, column));
  const std::string stated = own.empty() ? own : force_unit(own);
  const auto unit = quantity_unit(stated);
  if (!unit) text += " --unit UNIT";
  if (unit && stated != own) text += " --unit " + stated;
  if (const std::string time = time_options(dialect, column); !time.empty()) text += " " + time;
  const bool counts = unit && unit->quantity == daq::RawQuantity::kCounts;
  if (counts) text += " --count-range LOWEST..HIGHEST --volts-per-count VOLTS";
  if (counts || (unit && unit->quantity == daq::RawQuantity::kVolts)) text += " --load-cell-gain GAIN";
  if (!unit || unit->quantity != daq::RawQuantity::kCoefficient) text += " --sled-mass MASS";
  return text + options_text(request.dialect) + output_option(request.path);
}

/// What a file that is no text has beside the likely column and those that can be read with it.
std::string left_out(const Dialect& dialect) {
  if (!dialect.numbers) return {};
  const NumberFile& file = *dialect.numbers;
  std::string text;
  if (const std::string others = file.of_other_size(likely_column(dialect)); !others.empty())
    text += "of another length than " + others + "\n";
  if (const std::string refused = file.refused(); !refused.empty())
    text += fmt::format("no columns: {}\n", refused);
  return text;
}

}  // namespace

base::Error no_column_chosen(const ImportRequest& request, const Source& source, const Dialect& dialect) {
  const std::size_t column = likely_column(dialect);
  std::string unit = dialect.columns[column].unit;
  if (const auto table = read_table(source, dialect, column, std::nullopt);
      table && !table->cell_unit.empty())
    unit = table->cell_unit;
  return {base::ErrorKind::kUsage,
          fmt::format("{}: give {} NAME; there are {}: {}", request.path,
                      dialect.numbers ? dialect.numbers->option() : "--column", listed(dialect),
                      base::printable(command(request, dialect, unit)))};
}

Result<std::string> inspect(const ImportRequest& request) {
  const auto source = Source::of(request.path);
  if (!source) return tl::unexpected(source.error());
  const auto is_own = is_own_table(*source);  // recognise() reports files that are not text.
  const bool own = is_own && *is_own;
  const auto dialect = recognise(*source, request.dialect);
  if (!dialect) return tl::unexpected(dialect.error());
  using Column = io::Table::Column;
  constexpr auto kLeft = io::Table::Align::kLeft;
  std::vector<Column> headings{Column{.heading = "column"},
                               Column{.heading = "name", .align = kLeft},
                               Column{.heading = "unit", .align = kLeft},
                               Column{.heading = "first values", .align = kLeft},
                               Column{.heading = "smallest", .format = ".6g"},
                               Column{.heading = "largest", .format = ".6g"}};
  if (dialect->numbers) headings.insert(headings.begin() + 3, Column{.heading = "values"});
  io::Table columns{headings};
  std::string likely_unit;
  for (std::size_t c = 0; c < dialect->columns.size(); ++c) {
    std::string first;
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    std::string unit = dialect->columns[c].unit;
    if (dialect->numeric[c]) {
      auto table = read_table(*source, *dialect, c, std::nullopt);
      if (!table) {
        if (!dialect->numbers) return tl::unexpected(table.error());
        // A damaged variable hides no other.
        first = "cannot be read";
        table.emplace();
      }
      const base::LongColumn<double>& values = table->value;
      for (std::size_t i = 0; i < values.size(); ++i) {
        const double value = values[i];
        if (i < kFirstValues) first += fmt::format("{}{:.6g}", i == 0 ? "" : ", ", value);
        if (!std::isfinite(value)) continue;
        low = std::min(low, value);
        high = std::max(high, value);
      }
      if (!table->cell_unit.empty()) unit = table->cell_unit;
    } else {
      first = dialect->clock[c] ? clock_range(*source, *dialect, c) : "no numbers";
    }
    if (c == likely_column(*dialect)) likely_unit = unit;
    std::vector<io::Table::Cell> cells{io::cell(c + 1),
                                       base::one_line(dialect->columns[c].text, dialect->numbers ? 60 : 30),
                                       base::one_line(unit, 12),
                                       first,
                                       low,
                                       high};
    if (dialect->numbers) cells.insert(cells.begin() + 3, io::cell(dialect->numbers->size(c)));
    columns.add(cells);
  }
  const std::string import = own ? own_command(request.path) : command(request, *dialect, likely_unit);
  return dialect->text() + columns.text() + left_out(*dialect) + "to import: " + base::printable(import) +
         "\n";
}

}  // namespace stickslip::traces
