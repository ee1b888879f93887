#include "io/traces/dialect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "io/traces/number_file.hpp"
#include "io/traces/trace_time.hpp"

#include "core/base/wording.hpp"

namespace stickslip::traces {
namespace {

/// Of the beginning that is looked at, behind the lines to skip.
constexpr std::size_t kMostLines = 2000;
constexpr std::size_t kMostBytes = std::size_t{1} << 18U;
/// A column is numeric where so many of its cells are numbers or holes.
constexpr double kNumericShare = 0.9;
/// A reading is possible where so many of the lines after its first row are rows.
constexpr double kRowShare = 0.8;
/// A table is short where one so many times as long follows it.
constexpr std::size_t kShortTable = 10;
/// A reading that takes so many lines fewer as rows than another is not the right one.
constexpr std::size_t kFewerRows = 3;

struct Head {
  std::string first;               ///< Line of the file.
  std::vector<std::string> lines;  ///< Behind those that are skipped.
  std::int64_t skipped = 0;
  Encoding encoding = Encoding::kUtf8;

  /// \param number  from 1, of one in `lines`.
  [[nodiscard]] const std::string& line(std::int64_t number) const {
    return lines[static_cast<std::size_t>(number - 1 - skipped)];
  }
};

struct Row {
  std::int64_t line = 0;  ///< Of its beginning, from 1.
  std::vector<std::string> fields;
};

/// One way to read the file.
struct Reading {
  Dialect dialect;
  std::vector<Row> rows;
  std::size_t first = 0;  ///< Of the table, in rows.
  std::size_t texts = 0;  ///< Two for a column of text, one for a column of digits with zeros in front.
  std::size_t good = 0;   ///< Rows that are rows of the table.
};

base::Result<Head> read_head(const Source& source, const DialectOptions& options) {
  auto file = TextFile::open(source, options.encoding);
  if (!file) return tl::unexpected(file.error());
  Head head;
  head.encoding = file->encoding();
  std::size_t bytes = 0;
  std::string line;
  std::int64_t count = 0;
  while (head.lines.size() < kMostLines && bytes < kMostBytes) {
    const auto more = file->next(line);
    if (!more) return tl::unexpected(more.error());
    if (!*more) break;
    if (count == 0) head.first = line;
    if (count++ < options.skip) continue;
    bytes += line.size();
    head.lines.push_back(line);
  }
  head.skipped = std::min(count, options.skip);
  return head;
}

bool is_scans(const Row& row, const Dialect& dialect) {
  std::vector<Cell> cells;
  dialect.read_cells({row.fields.begin(), row.fields.end()}, cells);
  return dialect.is_row(cells);
}

std::vector<Row> rows_of(const Head& head, char separator, std::int64_t skip) {
  std::vector<Row> rows;
  RowReader reader{separator};
  bool open = false;
  for (std::size_t i = static_cast<std::size_t>(skip - head.skipped); i < head.lines.size(); ++i) {
    if (!open && trimmed(head.lines[i]).empty()) continue;
    if (!open) rows.push_back({head.skipped + static_cast<std::int64_t>(i) + 1, {}});
    open = !reader.add(head.lines[i]);
    if (!open) rows.back().fields.assign(reader.fields().begin(), reader.fields().end());
  }
  if (open) rows.pop_back();
  return rows;
}

/// "Force" of "Force:0.12".
std::string_view label_of(std::string_view field) {
  const std::size_t colon = field.find_first_of(":=");
  if (colon == std::string_view::npos || colon == 0) return {};
  const std::string_view label = trimmed(field.substr(0, colon));
  if (!label.empty() && label.find_first_of("0123456789") != std::string_view::npos) return {};
  return read_cell(field.substr(colon + 1), '.').kind == CellKind::kNumber ? label : std::string_view{};
}

bool has_number(const std::vector<std::string>& fields, char decimal) {
  return std::any_of(fields.begin(), fields.end(), [decimal](const std::string& field) {
    return read_cell(field, decimal).kind == CellKind::kNumber || !label_of(field).empty();
  });
}

/// The table's width, labels and kinds of columns. \return whether there are any.
bool find_columns(Reading& reading) {
  Dialect& dialect = reading.dialect;
  std::map<std::size_t, std::size_t> widths;
  for (const Row& row : reading.rows) {
    if (has_number(row.fields, dialect.decimal)) ++widths[row.fields.size()];
  }
  if (widths.empty()) return false;
  const std::size_t width = std::max_element(widths.begin(), widths.end(), [](const auto& a, const auto& b) {
                              return a.second < b.second;
                            })->first;
  dialect.columns.resize(width);
  dialect.numeric.assign(width, false);
  dialect.empty.assign(width, true);
  dialect.clock.assign(width, false);
  dialect.sparse.assign(width, false);
  std::vector<const Row*> alike;
  for (const Row& row : reading.rows) {
    if (row.fields.size() == width && has_number(row.fields, dialect.decimal)) alike.push_back(&row);
  }
  const Row& middle = *alike[alike.size() / 2];
  for (const std::string& field : middle.fields) dialect.labels.emplace_back(label_of(field));
  if (std::any_of(dialect.labels.begin(), dialect.labels.end(),
                  [](const std::string& label) { return label.empty(); })) {
    dialect.labels.clear();
  }
  bool any = false;
  std::size_t used = 0;  // Columns up to the last one that is not empty.
  for (std::size_t c = 0; c < width; ++c) {
    std::size_t numbers = 0;
    std::size_t texts = 0;
    std::size_t times = 0;
    std::size_t zeros = 0;
    std::size_t filled = 0;
    for (std::size_t i = 0; i < alike.size(); ++i) {
      const Row* const row = alike[i];
      const std::string_view text = dialect.content(c, row->fields[c]);
      const CellKind kind = read_cell(text, dialect.decimal).kind;
      numbers += kind == CellKind::kNumber ? 1U : 0U;
      // Rows of the same width may stand before the table: its second half alone tells its text.
      const bool is_text = kind == CellKind::kText && i >= alike.size() / 2;
      texts += is_text ? 1U : 0U;
      times += is_text && read_time_cell(text, dialect.decimal) ? 1U : 0U;
      zeros += text.size() > 1 && text.front() == '0' && text.find_first_not_of("0123456789") == text.npos;
      if (kind == CellKind::kEmpty) continue;
      ++filled;
      dialect.empty[c] = dialect.empty[c] && i < alike.size() / 2;
      used = c + 1;
    }
    dialect.numeric[c] = numbers > 0 && static_cast<double>(texts) <=
                                            (1.0 - kNumericShare) * static_cast<double>(alike.size());
    any = any || dialect.numeric[c];
    const auto most = [&alike](std::size_t count) {
      return static_cast<double>(count) > (1.0 - kNumericShare) * static_cast<double>(alike.size());
    };
    dialect.clock[c] = !dialect.numeric[c] && 2 * times > texts;
    dialect.constant.push_back(
        std::all_of(alike.begin() + static_cast<std::ptrdiff_t>(alike.size() / 2), alike.end(),
                    [&](const Row* row) { return row->fields[c] == middle.fields[c]; }));
    dialect.sparse[c] = !dialect.numeric[c] && 2 * filled < alike.size();
    reading.texts += !dialect.numeric[c] && texts > 0 && !most(times) ? 2U : 0U;
    reading.texts += dialect.numeric[c] && most(zeros) ? 1U : 0U;
  }
  // A separator at the end of each row has no column behind it.
  dialect.columns.resize(used);
  dialect.numeric.resize(used);
  dialect.empty.resize(used);
  dialect.clock.resize(used);
  dialect.sparse.resize(used);
  return any;
}

bool is_units_row(const Row& row) {
  return std::all_of(row.fields.begin(), row.fields.end(),
                     [](const std::string& field) { return trimmed(field).empty() || is_unit(field); });
}

bool is_heading(const Row& row, const Dialect& dialect);

/// Statistics may stand before the scans, as a short table with a heading of its own.
std::size_t after_short_tables(const Reading& reading, std::size_t first) {
  const auto& rows = reading.rows;
  const auto is_row = [&](std::size_t i) { return is_scans(rows[i], reading.dialect); };
  const auto end_of = [&](std::size_t begin) {
    while (begin < rows.size() && is_row(begin)) ++begin;
    return begin;
  };
  std::size_t end = end_of(first);
  for (std::size_t next = end; next < rows.size(); next = end_of(next) + 1) {
    const std::size_t size = end_of(next) - next;
    if (size < kShortTable * (end - first) || next <= end) continue;
    std::size_t heading = next - 1;
    if (heading > end && is_units_row(rows[heading])) --heading;
    const bool repeated = std::any_of(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(heading),
                                      [&](const Row& row) { return row.fields == rows[heading].fields; });
    if (is_heading(rows[heading], reading.dialect) && !repeated) {
      first = next;
      end = end_of(next);
    }
  }
  return first;
}

/// The first row that is followed by rows. \return whether the lines after it are rows as well.
bool find_first_row(Reading& reading) {
  const auto is_row = [&reading](const Row& row) { return is_scans(row, reading.dialect); };
  const auto& rows = reading.rows;
  std::size_t first = 0;
  while (first < rows.size() &&
         !(is_row(rows[first]) && (first + 1 >= rows.size() || is_row(rows[first + 1]))))
    ++first;
  if (first == rows.size()) {
    first = static_cast<std::size_t>(std::find_if(rows.begin(), rows.end(), is_row) - rows.begin());
    if (first == rows.size()) return false;
  }
  reading.first = first = after_short_tables(reading, first);
  reading.dialect.first_row_line = rows[first].line;
  const auto good = std::count_if(rows.begin() + static_cast<std::ptrdiff_t>(first), rows.end(), is_row);
  reading.good = static_cast<std::size_t>(good);
  return static_cast<double>(good) >=
             kRowShare * static_cast<double>(std::min<std::size_t>(rows.size() - first, 5)) &&
         2 * static_cast<std::size_t>(good) >= rows.size() - first;
}

bool is_heading(const Row& row, const Dialect& dialect) {
  const std::size_t width = dialect.columns.size();
  if (row.fields.size() < width) return false;
  std::size_t texts = 0;
  for (std::size_t c = 0; c < width; ++c) {
    if (!dialect.numeric[c]) continue;
    const CellKind kind = read_cell(row.fields[c], dialect.decimal).kind;
    if (kind == CellKind::kNumber && read_cell(row.fields[c], dialect.decimal).unit.empty()) return false;
    texts += kind == CellKind::kText ? 1U : 0U;
  }
  return texts > 0;
}

/// Names of a heading, each with the unit in brackets behind it, without the mark of a comment in front.
std::vector<std::string> names_between_blanks(const std::vector<std::string>& words) {
  std::vector<std::string> names;
  for (const std::string& word : words) {
    if (names.empty() && (word == "#" || word == "%" || word == "//")) continue;
    if (!names.empty() && (word.starts_with('(') || word.starts_with('['))) {
      names.back() += " " + word;
    } else {
      names.push_back(word);
    }
  }
  return names;
}

/// Names between two blanks or more, or tabs: "Time (s)   Normal Force (N)".
std::vector<std::string> names_between_wide_blanks(std::string_view line) {
  std::vector<std::string> names;
  line = trimmed(line);
  while (!line.empty()) {
    const std::size_t size = std::min({line.find("  "), line.find('\t'), line.size()});
    names.emplace_back(trimmed(line.substr(0, size)));
    line = trimmed(line.substr(size));
  }
  return names;
}

/// "-----+-----" between heading and scans.
bool is_rule(const Row& row) {
  return std::all_of(row.fields.begin(), row.fields.end(), [](const std::string& field) {
    return field.find_first_not_of("-+=:_ ") == std::string::npos;
  });
}

/// Vernier's text format has three rows above the scans: names, symbols, units.
bool is_vernier(const Head& head, const Reading& reading) {
  return head.first.starts_with("Vernier Format") && reading.first >= 3 &&
         is_heading(reading.rows[reading.first - 3], reading.dialect);
}

/// A row above the first scan that has its time, and a text in place of a value: "0.01;warming up".
bool is_early(const Row& row, const Dialect& dialect) {
  const std::size_t width = dialect.columns.size();
  const auto time = std::find(dialect.numeric.begin(), dialect.numeric.end(), true) - dialect.numeric.begin();
  return row.fields.size() >= width && !is_scans(row, dialect) &&
         read_cell(row.fields[static_cast<std::size_t>(time)], dialect.decimal).kind == CellKind::kNumber;
}

/// Whether rows are numbered from 1 on in a column without a name, as R's write.table does.
bool numbers_rows(const Reading& reading, const std::vector<std::string>& names) {
  const auto begins = [&reading](std::size_t row, std::string_view number) {
    const std::size_t i = reading.first + row;
    return i < reading.rows.size() && !reading.rows[i].fields.empty() &&
           reading.rows[i].fields.front() == number;
  };
  return !names.empty() && names.size() + 1 == reading.dialect.columns.size() && begins(0, "1") &&
         begins(1, "2") && !is_scan_counter(column_name(names.front()));
}

/// Whether a row right above the scans has names: is_heading(), or that of R; a heading with fewer names than
/// columns, of which those behind the last name begin later; or one with digits as names beside that of a
/// time.
bool has_names(const Row& row, const Reading& reading) {
  const Dialect& dialect = reading.dialect;
  if (is_heading(row, dialect)) return true;
  const auto is_text = [&](const std::string& field) {
    return read_cell(field, dialect.decimal).kind == CellKind::kText;
  };
  if (std::all_of(row.fields.begin(), row.fields.end(), is_text) && row.fields.size() > 1) {
    return numbers_rows(reading, row.fields) ||
           (dialect.separator != kBlanks && row.fields.size() < dialect.columns.size() &&
            row.fields.size() == reading.rows[reading.first].fields.size());
  }
  return row.fields.size() >= dialect.columns.size() && is_text(row.fields.front()) &&
         time_rank(column_name(row.fields.front())) > 0 &&
         std::all_of(row.fields.begin() + 1, row.fields.end(), [](const std::string& field) {
           return field.size() <= 2 && field.find_first_not_of("0123456789") == std::string::npos;
         });
}

/// Of several rows of words above the scans, that of the names: the one right above the units, else the one
/// with most words that are no units, of equal ones the lowest.
std::size_t names_row(const Reading& reading, std::size_t lowest) {
  constexpr std::size_t kMostRows = 4;
  const Dialect& dialect = reading.dialect;
  const auto& rows = reading.rows;
  const auto count = [&](std::size_t row, auto&& is_it) {
    const auto begin = rows[row].fields.begin();
    return std::count_if(begin, begin + static_cast<std::ptrdiff_t>(dialect.columns.size()), is_it);
  };
  const auto words = [&](std::size_t row) {
    return count(row, [](const std::string& field) { return !trimmed(field).empty() && !is_unit(field); });
  };
  std::size_t best = lowest;
  for (std::size_t i = lowest; lowest - i < kMostRows && is_heading(rows[i], dialect); --i) {
    if (i < lowest && i > 0 && is_units_row(rows[i]) && is_heading(rows[i - 1], dialect)) return i - 1;
    // Of two columns a row above may be a key and its value.
    if (dialect.columns.size() > 2 && words(i) > words(best)) best = i;
    // A time by its name, or a name with its unit, is in the row of names alone.
    const auto is_name = [](const std::string& field) {
      const ColumnName name = column_name(field);
      return time_rank(name) > 0 || (!name.name.empty() && !name.unit.empty());
    };
    if (i == 0 || count(i, is_name) > 0) break;
  }
  return best;
}

void find_heading(Reading& reading, const Head& head) {
  Dialect& dialect = reading.dialect;
  if (!dialect.labels.empty()) {
    for (std::size_t c = 0; c < dialect.columns.size(); ++c)
      dialect.columns[c] = column_name(dialect.labels[c]);
    return;
  }
  if (reading.first == 0) return;
  const auto& rows = reading.rows;
  std::size_t heading = reading.first - 1;
  const Row* units = nullptr;
  Row only_units;
  while (heading > 0 && is_rule(rows[heading])) --heading;
  std::size_t above = heading;
  while (above > 0 && is_early(rows[above], dialect)) --above;
  // A row with the other decimal mark looks early, too: only the name of a time makes a row above a heading.
  if (std::any_of(rows[above].fields.begin(), rows[above].fields.end(),
                  [](const std::string& field) { return time_rank(column_name(field)) > 0; }))
    heading = above;
  if (is_vernier(head, reading)) {
    units = &rows[reading.first - 1];
    heading = reading.first - 3;
  } else if (is_units_row(rows[heading]) && heading > 0 && is_heading(rows[heading - 1], dialect)) {
    units = &rows[heading--];
  } else if (const std::size_t names = names_row(reading, heading); names < heading) {
    heading = names;
    only_units = rows[heading + 1];
    for (std::string& field : only_units.fields) field = is_unit(field) ? field : std::string{};
    units = &only_units;
  }
  if (!has_names(rows[heading], reading)) return;
  const bool blanks = dialect.separator == kBlanks;
  std::vector<std::string> names = blanks ? names_between_blanks(rows[heading].fields) : rows[heading].fields;
  if (numbers_rows(reading, names)) names.insert(names.begin(), std::string{});
  if (blanks && names.size() != dialect.columns.size())
    names = names_between_wide_blanks(head.line(rows[heading].line));
  // A name with a blank in it shifts those behind it: no name is better than a wrong one.
  if (blanks && names.size() != dialect.columns.size()) {
    dialect.unclear_heading_line = rows[heading].line;
    return;
  }
  names.resize(std::max(names.size(), dialect.columns.size()));
  dialect.header_line = rows[heading].line;
  dialect.units_line = units == nullptr ? 0 : units->line;
  for (std::size_t c = 0; c < dialect.columns.size(); ++c) {
    std::string_view text = names[c];
    while (c == 0 && text.starts_with('#') && !trimmed(text.substr(1)).empty()) text.remove_prefix(1);
    dialect.columns[c] =
        column_name(text, units != nullptr && c < units->fields.size() ? units->fields[c] : std::string{});
  }
}

/// Further rows of the heading: those without a number.
void keep_rows_below_heading(Reading& reading) {
  constexpr std::size_t kMost = 4;
  Dialect& dialect = reading.dialect;
  for (std::size_t i = 0; i < reading.first && dialect.header_line > 0; ++i) {
    const Row& row = reading.rows[i];
    if (row.line <= dialect.header_line || dialect.rows_below_heading.size() == kMost) continue;
    if (has_number(row.fields, dialect.decimal)) continue;
    std::vector<std::string>& fields = dialect.rows_below_heading.emplace_back();
    for (const std::string& field : row.fields) fields.emplace_back(trimmed(field));
  }
}

std::optional<Reading> read_as(const Head& head, char separator, char decimal, std::int64_t skip) {
  Reading reading;
  reading.dialect.encoding = head.encoding;
  reading.dialect.separator = separator;
  reading.dialect.decimal = decimal;
  reading.rows = rows_of(head, separator, skip);
  if (!find_columns(reading) || !find_first_row(reading)) return std::nullopt;
  find_heading(reading, head);
  keep_rows_below_heading(reading);
  return reading;
}

/// The numbers of a row, for a message.
std::string shown(const Reading& reading, std::size_t place) {
  std::string text;
  const Row& row = reading.rows[place];
  for (std::size_t c = 0; c < row.fields.size() && c < 4; ++c) {
    const Cell cell = read_cell(reading.dialect.content(c, row.fields[c]), reading.dialect.decimal);
    if (!text.empty()) text += " and ";
    text += cell.kind == CellKind::kNumber ? fmt::format("{}", cell.value)
                                           : fmt::format("\"{}\"", base::one_line(row.fields[c], 20));
  }
  return text;
}

/// Rows above the table with the other decimal mark are no preamble: the mark changed within the file.
base::Result<void> refuse_other_mark(const Reading& reading, const std::string& path) {
  Dialect other = reading.dialect;
  other.decimal = reading.dialect.decimal == '.' ? ',' : '.';
  const Row* first = nullptr;
  std::size_t count = 0;
  for (std::size_t i = 0; i < reading.first; ++i) {
    const Row& row = reading.rows[i];
    // A heading below such rows shows that they are a preamble.
    if (reading.dialect.header_line > row.line || row.fields.size() < other.columns.size() ||
        is_scans(row, reading.dialect) || !is_scans(row, other))
      continue;
    if (count++ == 0) first = &row;
  }
  if (count < kFewerRows) return {};
  const std::int64_t below = reading.dialect.first_row_line;
  return base::usage_error(
      "{}:{}: \"{}\" is a row with the decimal mark '{}', and rows from line {} on have '{}': "
      "write one mark in the whole file, or give --skip {} if the lines above that one are no scans",
      path, first->line, base::one_line(fmt::format("{}", fmt::join(first->fields, " ")), 40), other.decimal,
      below, reading.dialect.decimal, below - 1);
}

/// The cells of a row that are not empty.
std::vector<Cell> cells_of(const Row& row, char decimal) {
  std::vector<Cell> cells;
  for (const std::string& field : row.fields) {
    const Cell cell = read_cell(field, decimal);
    if (cell.kind != CellKind::kEmpty) cells.push_back(cell);
  }
  return cells;
}

/// Whether both give the same values; columns that are empty do not count.
bool equal(const Reading& a, const Reading& b) {
  if (a.rows[a.first].line != b.rows[b.first].line || a.rows.size() - a.first != b.rows.size() - b.first)
    return false;
  for (std::size_t i = 0; a.first + i < a.rows.size(); ++i) {
    const auto one = cells_of(a.rows[a.first + i], a.dialect.decimal);
    const auto other = cells_of(b.rows[b.first + i], b.dialect.decimal);
    if (!std::equal(one.begin(), one.end(), other.begin(), other.end(),
                    [](const Cell& x, const Cell& y) { return x.kind == y.kind && x.value == y.value; }))
      return false;
  }
  return true;
}

/// A heading of several names with commas and no blank behind one is no name with a decimal comma below it.
bool heading_says_commas(const Reading& commas, const Head& head) {
  const std::int64_t line = commas.dialect.header_line;
  if (commas.dialect.separator != ',' || line == 0 || commas.dialect.columns.size() < 2) return false;
  return head.line(line).find(", ") == std::string::npos;
}

/// Names in the row above the scans, where the rows have twice as many fields, none with a point and each
/// second one of digits alone: the comma may be the decimal mark too. 0: it is not.
std::size_t names_with_decimal_commas(const Reading& reading) {
  if (reading.dialect.separator != ',' || reading.first == 0) return 0;
  const std::size_t names = reading.rows[reading.first - 1].fields.size();
  const auto begin = reading.rows.begin() + static_cast<std::ptrdiff_t>(reading.first);
  const bool both = std::all_of(begin, reading.rows.end(), [names](const Row& row) {
    for (std::size_t c = 0; c < row.fields.size(); ++c) {
      const bool is_whole = c % 2 == 0;
      if (is_whole ? row.fields[c].find('.') != std::string::npos
                   : row.fields[c].find_first_not_of("0123456789") != std::string::npos)
        return false;
    }
    return row.fields.size() == 2 * names;
  });
  return both && !has_number(reading.rows[reading.first - 1].fields, '.') ? names : 0;
}

std::string option_of(const Reading& reading, const Reading& other) {
  if (reading.dialect.decimal != other.dialect.decimal)
    return fmt::format("--decimal \"{}\"", reading.dialect.decimal);
  return fmt::format("--separator {}", separator_name(reading.dialect.separator));
}

base::Result<Dialect> dialect_of_numbers(std::shared_ptr<NumberFile> numbers, const std::string& path,
                                         const DialectOptions& options) {
  if (options.encoding || options.separator || options.decimal || options.skip > 0) {
    return base::usage_error(
        "{}: is a file of {}: leave out --encoding, --separator, --decimal and --skip, which are for text",
        path, numbers->format());
  }
  Dialect dialect;
  for (std::size_t c = 0; c < numbers->count(); ++c) dialect.columns.push_back(numbers->column_name(c));
  dialect.numeric.assign(numbers->count(), true);
  dialect.clock.assign(numbers->count(), false);
  dialect.sparse.assign(numbers->count(), false);
  dialect.empty.assign(numbers->count(), false);
  dialect.numbers = std::move(numbers);
  return dialect;
}

}  // namespace

std::string_view Dialect::content(std::size_t column, std::string_view field) const {
  if (column >= labels.size()) return field;
  const std::size_t mark = field.find_first_of(":=");
  if (mark == std::string_view::npos || trimmed(field.substr(0, mark)) != labels[column]) return field;
  return field.substr(mark + 1);
}

void Dialect::read_cells(const std::vector<std::string_view>& fields, std::vector<Cell>& cells) const {
  for (std::size_t c = 0; c < fields.size(); ++c) {
    cells.push_back(c >= columns.size() || numeric[c] ? read_cell(content(c, fields[c]), decimal) : Cell{});
  }
}

bool Dialect::is_row(std::span<const Cell> cells) const {
  bool any = false;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const bool is_number = cells[c].kind == CellKind::kNumber;
    // A comment may stand behind the numbers.
    if (c < columns.size() ? numeric[c] && cells[c].kind == CellKind::kText : is_number) return false;
    any = any || is_number;
  }
  return any;
}

std::optional<std::size_t> Dialect::label_column(const std::vector<std::string_view>& fields) const {
  for (std::size_t c = 0; c < columns.size() && c < fields.size() && !numeric[c]; ++c) {
    if (!clock[c] && !sparse[c]) continue;
    const std::string_view text = trimmed(fields[c]);
    if (read_cell(text, decimal).kind == CellKind::kText && !(clock[c] && read_time_cell(text, decimal)))
      return c;
  }
  return std::nullopt;
}

std::string Dialect::text(std::optional<std::size_t> value) const {
  if (numbers) {
    return fmt::format("recognised: {}{}\ncolumns: {}\n", numbers->format(),
                       value ? ", " + numbers->called(*value) : "", numbers->listed());
  }
  std::string names;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (c > 0) names += ", ";
    names += columns[c].text.empty() ? fmt::format("{}", c + 1) : base::one_line(columns[c].text, 40);
  }
  return fmt::format("recognised: {}, separator {}, decimal {}, {}, rows from line {}\ncolumns: {}\n",
                     name(encoding), separator_name(separator), decimal == '.' ? "point" : "comma",
                     header_line > 0   ? fmt::format("heading in line {}", header_line)
                     : !labels.empty() ? std::string{"a label in each cell"}
                                       : std::string{"no heading"},
                     first_row_line, names);
}

std::string options_text(const DialectOptions& options) {
  std::string text;
  if (options.encoding) text += fmt::format(" --encoding {}", name(*options.encoding));
  if (options.separator) text += fmt::format(" --separator {}", separator_name(*options.separator));
  if (options.decimal) text += fmt::format(" --decimal {}", *options.decimal == '.' ? "point" : "comma");
  if (options.skip > 0) text += fmt::format(" --skip {}", options.skip);
  return text;
}

bool is_no_row(std::string_view line) {
  const std::string_view text = trimmed(line);
  return text.empty() || text.front() == '#' || text.front() == '%' || text.starts_with("//");
}

base::Result<Dialect> recognise(const Source& source, const DialectOptions& options) {
  const std::string& path = source.path;
  auto numbers = NumberFile::open(source);
  if (!numbers) return tl::unexpected(numbers.error());
  if (*numbers) return dialect_of_numbers(*std::move(numbers), path, options);
  auto head = read_head(source, options);
  if (!head) return tl::unexpected(head.error());
  if (head->lines.empty() && head->skipped > 0)
    return base::usage_error("{}: has {} lines, and --skip {} leaves none: give a smaller one", path,
                             head->skipped, options.skip);
  if (head->lines.empty()) return base::usage_error("{}: is empty: a table of numbers is needed", path);
  DialectOptions stated = options;
  if (const std::string_view first = head->first; first.starts_with("sep=") && first.size() == 5) {
    if (!stated.separator) stated.separator = first.back();
    stated.skip = std::max<std::int64_t>(stated.skip, 1);
  }
  std::vector<Reading> readings;
  // Numbers in quotes may have the separator as their decimal mark.
  const bool quoted = std::any_of(head->lines.begin(), head->lines.end(), [](const std::string& line) {
    return line.find('"') != std::string::npos;
  });
  for (const char separator : {'\t', ';', ',', '|', kNoSeparator, kBlanks}) {
    for (const char decimal : {'.', ','}) {
      if ((separator == decimal && !quoted) || (stated.separator && *stated.separator != separator) ||
          (stated.decimal && *stated.decimal != decimal))
        continue;
      auto reading = read_as(*head, separator, decimal, stated.skip);
      if (!reading) continue;
      if (std::none_of(readings.begin(), readings.end(),
                       [&](const Reading& other) { return equal(*reading, other); }))
        readings.push_back(std::move(*reading));
    }
  }
  if (readings.empty()) {
    // Words may stand above the table.
    const auto& lines = head->lines;
    const auto skipped =
        lines.begin() + std::min<std::ptrdiff_t>(stated.skip - head->skipped, std::ssize(lines));
    auto sample = std::find_if(skipped, lines.end(), [](const std::string& line) {
      return !is_no_row(line) && line.find_first_of("0123456789") != std::string::npos;
    });
    if (sample == lines.end()) sample = lines.begin();
    return base::usage_error(
        "{}:{}: no table of numbers is found in its first {} lines; this one cannot be read: \"{}\". "
        "State what you see, --encoding, --separator, --decimal, --skip, or export the trace as a table of "
        "text (CSV)",
        path, head->skipped + (sample - lines.begin()) + 1, head->skipped + std::ssize(lines),
        base::one_line(*sample, 60));
  }
  const std::size_t fewest =
      std::min_element(readings.begin(), readings.end(), [](const Reading& a, const Reading& b) {
        return a.texts < b.texts;
      })->texts;
  std::erase_if(readings, [fewest](const Reading& reading) { return reading.texts > fewest; });
  const std::size_t most =
      std::max_element(readings.begin(), readings.end(), [](const Reading& a, const Reading& b) {
        return a.good < b.good;
      })->good;
  std::erase_if(readings, [most](const Reading& reading) { return reading.good + kFewerRows <= most; });
  if (std::any_of(readings.begin(), readings.end(),
                  [&](const Reading& reading) { return heading_says_commas(reading, *head); }))
    std::erase_if(readings, [](const Reading& reading) { return reading.dialect.separator != ','; });
  if (readings.size() > 1) {
    const Reading& one = readings[0];
    const Reading& other = readings[1];
    // The first line that shows what differs.
    std::size_t i = one.first;
    std::size_t j = other.first;
    while (i + 1 < one.rows.size() && j + 1 < other.rows.size() &&
           (one.rows[i].line != other.rows[j].line || shown(one, i) == shown(other, j)))
      ++(one.rows[i].line <= other.rows[j].line ? i : j);
    const bool differs = one.rows[i].line == other.rows[j].line && shown(one, i) != shown(other, j);
    if (!differs) {
      i = one.first;
      j = other.first;
    }
    const std::int64_t line = one.rows[i].line;
    return base::usage_error(
        "{}:{}: \"{}\" has two readings: {} ({}), or {} ({}). Give the option that is right", path, line,
        base::one_line(head->line(line), 40), shown(one, i), option_of(one, other), shown(other, j),
        option_of(other, one));
  }
  const std::size_t names = names_with_decimal_commas(readings.front());
  if (names > 0 && !stated.separator && !stated.decimal) {
    const Reading& one = readings.front();
    return base::usage_error(
        "{}:{}: \"{}\" has two readings: {} columns, or {} with decimal commas, as the {} names above them "
        "say. Give --separator comma for {} columns; else export the file with semicolons between the "
        "columns",
        path, one.dialect.first_row_line, base::one_line(head->line(one.dialect.first_row_line), 40),
        2 * names, names, names, 2 * names);
  }
  if (auto clear = refuse_other_mark(readings.front(), path); !clear) return tl::unexpected(clear.error());
  readings.front().dialect.decimal_is_stated = options.decimal.has_value();
  return readings.front().dialect;
}

}  // namespace stickslip::traces
