#include "io/traces/trace_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <future>
#include <limits>
#include <set>
#include <span>
#include <utility>

#include "io/traces/number_file.hpp"
#include "io/traces/repeated_heading.hpp"
#include "io/traces/time_unit.hpp"
#include "io/traces/trace_time.hpp"

#include "core/base/nan.hpp"
#include "core/base/quantity.hpp"
#include "core/base/wording.hpp"

namespace stickslip::traces {
namespace {

constexpr std::size_t kLongestShown = 40;
constexpr double kWholeDay_s = 86'400.0;

/// The best of the columns by `rank`, and of equal ones the nearest before `column`, else the first after it.
template <typename Rank>
std::optional<std::size_t> best_before(const Dialect& dialect, std::size_t column, Rank rank) {
  std::optional<std::size_t> best;
  int best_rank = 0;
  for (std::size_t c = 0; c < dialect.columns.size(); ++c) {
    int own = c == column || dialect.empty[c] ? 0 : rank(c);
    if (own > 0 && dialect.numbers) {
      // The group counts more than the name.
      constexpr int kRanks = 10;
      const auto nearness = dialect.numbers->nearness(c, column);
      own = nearness ? own + kRanks * *nearness : 0;
    }
    if (own == 0 || own < best_rank) continue;
    if (own == best_rank && c > column) continue;
    best = c;
    best_rank = own;
  }
  return best;
}

/// Lines at the end that are no scans, unless they are few beside the scans.
constexpr std::size_t kLongestFooter = 100;

/// Some rows of a table, one behind the other.
struct Rows {
  struct Row {
    std::int64_t line = 0;  ///< Of its beginning, from 1.
    std::size_t end = 0;    ///< Of its fields, in ends.
  };
  std::vector<Row> rows;
  std::string text;                  ///< Of all fields.
  std::vector<std::size_t> ends;     ///< Of each field, in text.
  std::vector<Cell> cells;           ///< Of each field, by Dialect::read_cells().
  bool is_end = false;               ///< No rows follow.
  std::optional<base::Error> error;  ///< Why the file could not be read further; then is_end.

  /// Keeps the memory.
  void clear() {
    rows.clear();
    text.clear();
    ends.clear();
    cells.clear();
    is_end = false;
    error.reset();
  }

  /// Calls use(fields, cells, line) for each row until it returns false.
  template <typename Use>
  void for_each(const Use& use) const {
    std::vector<std::string_view> fields;
    std::size_t field = 0;
    std::size_t begin = 0;
    for (const Row& row : rows) {
      const std::size_t first = field;
      fields.clear();
      for (; field < row.end; begin = ends[field++])
        fields.push_back(std::string_view{text}.substr(begin, ends[field] - begin));
      const std::span<const Cell> own =
          cells.empty() ? std::span<const Cell>{} : std::span{cells}.subspan(first, fields.size());
      if (!use(fields, own, row.line)) return;
    }
  }
};

/// Splits the lines of a table into fields.
class RowSplitter {
 public:
  RowSplitter(TextFile& file, const Dialect& dialect)
      : file_(file), dialect_(dialect), reader_(dialect.separator) {}

  /// Replaces `rows` by the next ones, without cells.
  void next(Rows& rows) {
    constexpr std::size_t kMost = std::size_t{1} << 14U;
    constexpr std::size_t kMostBytesAtOnce = std::size_t{1} << 20U;
    rows.clear();
    while (rows.rows.size() < kMost &&
           rows.text.size() + rows.ends.size() * (sizeof(std::size_t) + sizeof(Cell)) < kMostBytesAtOnce) {
      const auto more = file_.next(line_);
      rows.is_end = !more || !*more;
      if (!more) rows.error = more.error();
      if (rows.is_end) break;
      if (file_.line_number() < dialect_.first_row_line || (!open_ && is_no_row(line_))) continue;
      if (!open_) row_line_ = file_.line_number();
      open_ = !reader_.add(line_);
      if (open_) continue;
      for (const std::string_view field : reader_.fields()) {
        rows.text += field;
        rows.ends.push_back(rows.text.size());
      }
      rows.rows.push_back({row_line_, rows.ends.size()});
    }
  }

  /// Whether the file ended within a row, and where that begins.
  [[nodiscard]] bool is_open() const noexcept { return open_; }
  [[nodiscard]] std::int64_t row_line() const noexcept { return row_line_; }

 private:
  TextFile& file_;
  const Dialect& dialect_;
  RowReader reader_;
  std::string line_;
  std::int64_t row_line_ = 0;
  bool open_ = false;
};

class TableReader {
 public:
  TableReader(const Source& source, const Dialect& dialect, std::size_t value_column,
              std::optional<std::size_t> time_column, const std::filesystem::path& scratch_folder)
      : source_(source),
        path_(source.path),
        dialect_(dialect),
        value_column_(value_column),
        time_column_(time_column),
        heading_(dialect),
        table_(scratch_folder) {}

  base::Result<TraceTable> read() {
    auto file = TextFile::open(source_, dialect_.encoding);
    if (!file) return tl::unexpected(file.error());
    RowSplitter splitter{*file, dialect_};
    if (auto taken = take_rows_of(splitter); !taken) return tl::unexpected(taken.error());
    leave_out_labelled();
    if (splitter.is_open()) strange(splitter.row_line(), "a quote that does not end");
    if (!file->line_was_ended()) leave_out_cut_line(file->line_number());
    if (table_.value.empty() && strange_rows_ > 0) {
      return base::usage_error("{}:{}: {}: no number and no time; choose another column", path_,
                               strange_line_, strange_what_);
    }
    if (strange_rows_ > kLongestFooter && strange_rows_ > table_.value.size() / 10) {
      if (other_heading_line_ > 0) return other_heading();
      return base::usage_error(
          "{}:{}: {}, and the {} lines from there to the end are like it: correct them or remove them", path_,
          strange_line_, strange_what_, strange_rows_);
    }
    tell_left_out();
    table_.sha256 = file->sha256();
    table_.size = file->bytes_read();
    return std::move(table_);
  }

 private:
  static std::string_view field(const std::vector<std::string_view>& fields, std::size_t column) {
    return column < fields.size() ? fields[column] : std::string_view{};
  }

  /// Of the row in cells_. \param content  of its field in this column.
  [[nodiscard]] Cell cell(std::size_t column, std::string_view content) const {
    const bool is_read =
        column < cells_.size() && (column >= dialect_.columns.size() || dialect_.numeric[column]);
    return is_read ? cells_[column] : read_cell(content, dialect_.decimal);
  }

  void strange(std::int64_t line, std::string what) {
    if (strange_rows_++ > 0) return;
    strange_line_ = line;
    strange_what_ = std::move(what);
  }

  void tell_left_out() {
    if (strange_rows_ == 0) return;
    table_.notes.push_back(fmt::format("{} line{} from line {} on left out: no scans", strange_rows_,
                                       strange_rows_ == 1 ? "" : "s", strange_line_));
    strange_rows_ = 0;
    other_heading_line_ = 0;
  }

  [[nodiscard]] tl::unexpected<base::Error> other_heading() const {
    return base::usage_error("{}:{}: {}: put this table, with its heading, into a file of its own", path_,
                             other_heading_line_, other_heading_);
  }

  /// The column, and what stands in it, for which this is no row of scans. \param no_time  the time is text.
  [[nodiscard]] std::string wrong_cell(const std::vector<std::string_view>& fields, bool no_time) const {
    std::size_t wrong = value_column_;
    const auto is_text = [&](std::size_t c) { return cells_[c].kind == CellKind::kText; };
    if (wrong >= fields.size() ||
        cell(wrong, dialect_.content(wrong, fields[wrong])).kind != CellKind::kText) {
      if (no_time) wrong = *time_column_;
      for (std::size_t c = 0; !no_time && c < fields.size() && wrong == value_column_; ++c) {
        if (c >= dialect_.columns.size() ? cells_[c].kind == CellKind::kNumber
                                         : dialect_.numeric[c] && is_text(c))
          wrong = c;
      }
    }
    const std::string text =
        base::one_line(trimmed(dialect_.content(wrong, field(fields, wrong))), kLongestShown);
    return wrong < dialect_.columns.size() ? fmt::format("{} is '{}'", column_shown(wrong), text)
                                           : fmt::format("there is '{}' in column {}, and the table has {}",
                                                         text, wrong + 1, dialect_.columns.size());
  }

  [[nodiscard]] std::string column_shown(std::size_t column) const {
    const std::string& text = dialect_.columns[column].text;
    return text.empty() ? fmt::format("column {}", column + 1)
                        : fmt::format("column '{}'", base::one_line(text, kLongestShown));
  }

  /// All rows to the end of the file, or to an error.
  base::Result<void> take_rows_of(RowSplitter& splitter) {
    // Rows are split one piece after the other, some pieces ahead; meanwhile cells of those before are read,
    // and this thread takes those before them.
    constexpr std::size_t kPieces = 4;
    struct Piece {
      Rows rows;
      std::shared_future<void> split;
      std::future<void> read;
    };
    std::array<Piece, kPieces> pieces;
    // A split may be waited for by that of another piece alone.
    struct WaitForAll {
      const std::array<Piece, kPieces>& pieces;
      ~WaitForAll() {
        for (const Piece& piece : pieces) {
          if (piece.split.valid()) piece.split.wait();
        }
      }
    } const waiting{pieces};
    const auto start = [&](Piece& piece, const std::shared_future<void>& before) {
      // Named, as async moves what it is given before it knows whether there is room for a thread. The one
      // before is let go, or all would be kept.
      const auto split = [&splitter, &rows = piece.rows,
                          before = std::shared_future<void>{before}]() mutable {
        if (before.valid()) std::exchange(before, {}).get();
        splitter.next(rows);
      };
      piece.split = std::async(split).share();
      const auto read = [this, &rows = piece.rows, own = piece.split] {
        own.get();
        read_cells(rows);
      };
      piece.read = std::async(read);
    };
    std::shared_future<void> before;
    for (Piece& piece : pieces) {
      start(piece, before);
      before = piece.split;
    }
    for (std::size_t i = 0;; i = (i + 1) % kPieces) {
      Piece& piece = pieces[i];
      piece.read.get();
      auto taken = take_all(piece.rows);
      if (!taken || piece.rows.is_end) return taken;
      start(piece, before);
      before = piece.split;
    }
  }

  /// From the text of the rows, into which the cells point.
  void read_cells(Rows& rows) const {
    std::vector<Cell> cells = std::move(rows.cells);
    rows.cells.clear();
    cells.clear();
    rows.for_each([&](const std::vector<std::string_view>& fields, std::span<const Cell>, std::int64_t) {
      dialect_.read_cells(fields, cells);
      return true;
    });
    rows.cells = std::move(cells);
  }

  base::Result<void> take_all(const Rows& rows) {
    base::Result<void> taken;
    rows.for_each(
        [&](const std::vector<std::string_view>& fields, std::span<const Cell> cells, std::int64_t line) {
          cells_ = cells;
          taken = take(fields, line);
          return taken.has_value();
        });
    if (taken && rows.error) return tl::unexpected(*rows.error);
    return taken;
  }

  base::Result<void> take(const std::vector<std::string_view>& fields, std::int64_t line) {
    if (std::all_of(fields.begin(), fields.end(),
                    [](std::string_view text) { return trimmed(text).empty(); }))
      return {};
    using Again = RepeatedHeading::Again;
    if (const Again again = heading_.again(fields, cells_, below_heading_); again != Again::kNo) {
      // Another table of the same kind begins; what stands between the two is no scan. Units alone do not
      // tell what the columns are.
      below_heading_ = below_heading_ || again == Again::kHeading;
      if (below_heading_) tell_left_out();
      table_.notes.push_back(fmt::format("line {} left out: the heading or its units again", line));
      return {};
    }
    const std::string_view value_text = dialect_.content(value_column_, field(fields, value_column_));
    const Cell value = cell(value_column_, value_text);
    std::optional<TimeCell> time;
    std::string_view time_text;
    Cell number;
    bool no_time = false;
    bool time_is_hole = false;
    if (time_column_) {
      time_text = trimmed(dialect_.content(*time_column_, field(fields, *time_column_)));
      number = cell(*time_column_, time_text);
      time = read_time_cell(time_text, number, dialect_.decimal);
      no_time = !time;
      time_is_hole = no_time && number.kind != CellKind::kText;
    }
    if (value.kind == CellKind::kText || (no_time && !time_is_hole) || !dialect_.is_row(cells_)) {
      if (strange_rows_ == 0) {
        words_alone_ = dialect_.columns.size() > 1 &&
                       std::none_of(fields.begin(), fields.end(), [&](std::string_view text) {
                         return read_cell(text, dialect_.decimal).kind == CellKind::kNumber;
                       });
      }
      if (other_heading_line_ == 0) other_heading_ = heading_.change(fields);
      if (other_heading_line_ == 0 && !other_heading_.empty()) {
        other_heading_line_ = line;
        below_heading_ = false;
      }
      strange(line, wrong_cell(fields, no_time && !time_is_hole));
      return {};
    }
    const bool hole = value.kind != CellKind::kNumber;
    if (hole && no_time) return {};
    if (other_heading_line_ > 0) return other_heading();
    if (strange_rows_ > 0) {
      return base::usage_error(
          "{}:{}: {}, and scans follow in line {}: a number is needed there; correct the line, or remove "
          "it{}",
          path_, strange_line_, strange_what_, line,
          words_alone_ ? " and those below it if they are no scans" : "");
    }
    if (time && number.kind == CellKind::kNumber && !to_seconds(*time, number.unit)) {
      return base::usage_error(
          "{}:{}: {} is '{}': a time has one of the units s, ms, us, ns, min and h, in all rows or in none; "
          "correct the line",
          path_, line, column_shown(*time_column_), base::one_line(time_text, kLongestShown));
    }
    if (no_time) {
      return base::usage_error(
          "{}:{}: {} has no time beside the value {}: give --time-column none and --rate HZ if the scans "
          "are evenly spaced",
          path_, line, column_shown(*time_column_), value.value);
    }
    if (!hole) {
      if (auto clear = check_mark(value, value_text, line); !clear) return clear;
      if (any_value_ && value.unit != table_.cell_unit) {
        return base::usage_error("{}:{}: {} is '{}', the rows before are in {}: correct the line", path_,
                                 line, column_shown(value_column_), base::one_line(value_text, kLongestShown),
                                 table_.cell_unit.empty() ? "no unit" : base::one_line(table_.cell_unit, 20));
      }
      table_.cell_unit = value.unit;
      any_value_ = true;
    }
    below_heading_ = false;
    if (time && !time->unclear_date.empty()) note_date(*time, line);
    note_label(fields);
    add(hole ? base::kNaN : value.value, time, line);
    // The last number of the line, which would be cut first.
    last_decimals_ = cell(fields.size() - 1, dialect_.content(fields.size() - 1, fields.back())).decimals;
    last_fields_ = fields.size();
    if (file_rows_++ > 0) {
      most_decimals_ = std::max(most_decimals_, previous_decimals_);
      most_fields_ = std::max(most_fields_, previous_fields_);
    }
    previous_decimals_ = last_decimals_;
    previous_fields_ = last_fields_;
    return {};
  }

  /// By the unit in its cell, if that has one. \return false if that is no time or only some rows have one.
  bool to_seconds(TimeCell& time, std::string_view unit) {
    if (unit.empty()) return !table_.time_unit_in_cells;
    if (!table_.time.empty() && !table_.time_unit_in_cells) return false;
    if (unit != time_unit_) {
      const auto seconds =
          base::parse_quantity("1 " + plain_time_unit(std::string{unit}), base::Dimension::kTime);
      if (!seconds) return false;
      time_unit_ = unit;
      time_unit_s_ = *seconds;
    }
    table_.time_unit_in_cells = true;
    time.value *= time_unit_s_;
    time.decimals -= static_cast<int>(std::ceil(std::log10(time_unit_s_) - 1e-9));
    return true;
  }

  /// Tells that dates are not read, and where one changes though the clock does not pass midnight.
  void note_date(const TimeCell& time, std::int64_t line) {
    const std::string_view date = time.unclear_date;
    if (unclear_date_.empty()) {
      table_.notes.push_back(
          fmt::format("dates such as {} are not read, as the order of day, month and year is not "
                      "known: the clock alone counts",
                      base::one_line(date, kLongestShown)));
    } else if (date != unclear_date_ && !date_change_is_told_ &&
               last_clock_s_ - time.value < 0.5 * kWholeDay_s) {
      date_change_is_told_ = true;
      table_.notes.push_back(fmt::format(
          "line {}: the date becomes {} where the clock does not pass midnight: days that lie between are "
          "not counted; dates as 2026-11-25 are",
          line, base::one_line(date, kLongestShown)));
    }
    unclear_date_ = date;
  }

  /// "0.123" above "6,944" in one column: 6944 or 6.944, nobody can tell.
  base::Result<void> check_mark(const Cell& value, std::string_view text, std::int64_t line) {
    if (dialect_.decimal_is_stated || (!value.one_group && value.decimals <= 0)) return {};
    MarkPlace& own = value.one_group ? grouped_ : decimal_;
    if (own.line == 0) own = {line, std::string{text}};
    if (grouped_.line == 0 || decimal_.line == 0) return {};
    std::string other = grouped_.text;
    std::replace(other.begin(), other.end(), dialect_.decimal == '.' ? ',' : '.', dialect_.decimal);
    return base::usage_error(
        "{}:{}: {} is '{}', and '{}' in line {}: {} or {}. Give --decimal \"{}\" if it is {}, else write one "
        "mark of "
        "decimals in the whole column",
        path_, grouped_.line, column_shown(value_column_), base::one_line(grouped_.text, kLongestShown),
        base::one_line(decimal_.text, kLongestShown), decimal_.line,
        read_cell(grouped_.text, dialect_.decimal).value, read_cell(other, dialect_.decimal).value,
        dialect_.decimal, read_cell(grouped_.text, dialect_.decimal).value);
  }

  void add(double value, const std::optional<TimeCell>& time, std::int64_t line) {
    if (time) {
      if (table_.time.empty()) {
        table_.first_time = time->value;
        table_.date_s = time->date_s;
        table_.time_in_seconds = time->in_seconds || table_.time_unit_in_cells;
      }
      // A clock without a date that goes back by more than half a day has passed midnight.
      if (time->in_seconds && !time->date_s && last_clock_s_ - time->value > 0.5 * kWholeDay_s)
        midnights_s_ += kWholeDay_s;
      last_clock_s_ = time->in_seconds ? time->value : 0.0;
      const std::int64_t days = time->date_s && table_.date_s ? *time->date_s - *table_.date_s : 0;
      table_.time.push_back(time->value - table_.first_time + static_cast<double>(days) + midnights_s_);
      table_.time_decimals = std::max(table_.time_decimals, time->decimals);
    }
    const std::size_t row = table_.value.size();
    table_.value.push_back(value);
    if (table_.places.empty() || table_.line(row) != line) table_.places.emplace_back(row, line);
  }

  /// A word in a column that has words above as well is an event, and this row a scan.
  void note_label(const std::vector<std::string_view>& fields) {
    const auto column = dialect_.label_column(fields);
    if (column) {
      label_columns_.push_back(*column);
      if (!event_columns_.contains(*column)) {
        ++labelled_;
        return;
      }
    }
    labelled_ = 0;
    event_columns_.insert(label_columns_.begin(), label_columns_.end());
    label_columns_.clear();
  }

  /// Statistics below the scans.
  void leave_out_labelled() {
    const std::size_t rows = table_.value.size();
    if (labelled_ == 0 || labelled_ > kLongestFooter || labelled_ >= rows) return;
    const std::int64_t first = table_.line(rows - labelled_);
    table_.value.truncate(rows - labelled_);
    if (!table_.time.empty()) table_.time.truncate(rows - labelled_);
    table_.notes.push_back(fmt::format("{} line{} from line {} on left out: a word stands before the numbers",
                                       labelled_, labelled_ == 1 ? "" : "s", first));
  }

  /// A file that was cut by a full disk ends in the middle of a number.
  void leave_out_cut_line(std::int64_t line) {
    if (file_rows_ < 2 || table_.line(table_.value.size() - 1) != line) return;
    if (last_fields_ >= most_fields_ && last_decimals_ >= most_decimals_) return;
    table_.value.pop_back();
    if (!table_.time.empty()) table_.time.pop_back();
    table_.notes.push_back(fmt::format(
        "line {} left out: it is the last one, has no line end, and is shorter than the others", line));
  }

  const Source& source_;
  std::string path_;
  const Dialect& dialect_;
  std::size_t value_column_;
  std::optional<std::size_t> time_column_;
  RepeatedHeading heading_;
  TraceTable table_;
  std::size_t strange_rows_ = 0;  ///< That are no scans, since the last scan.
  std::int64_t strange_line_ = 0;
  std::string strange_what_;
  bool words_alone_ = false;             ///< No number stands there: maybe the heading of a table of results.
  bool below_heading_ = false;           ///< The heading stands again since the last scan.
  std::int64_t other_heading_line_ = 0;  ///< Of one that differs, since the last scan; 0: none.
  std::string other_heading_;            ///< What differs.
  bool any_value_ = false;
  std::span<const Cell> cells_;  ///< Of the row at hand.
  struct MarkPlace {
    std::int64_t line = 0;
    std::string text;
  };
  std::string time_unit_;                   ///< In the cell of the last row.
  double time_unit_s_ = 1.0;                ///< Of it.
  MarkPlace grouped_;                       ///< First value with Cell::one_group.
  MarkPlace decimal_;                       ///< First value with decimals.
  std::size_t labelled_ = 0;                ///< Rows with a label since the last one without.
  std::vector<std::size_t> label_columns_;  ///< Their columns.
  std::set<std::size_t> event_columns_;     ///< That have words above those rows.
  std::string unclear_date_;                ///< TimeCell::unclear_date of the last row.
  bool date_change_is_told_ = false;
  double last_clock_s_ = 0.0;
  double midnights_s_ = 0.0;
  std::size_t file_rows_ = 0;
  int last_decimals_ = 0;
  int previous_decimals_ = 0;
  int most_decimals_ = 0;  ///< Of all rows but the last one.
  std::size_t last_fields_ = 0;
  std::size_t previous_fields_ = 0;
  std::size_t most_fields_ = 0;
};

}  // namespace

std::string listed(const Dialect& dialect) {
  if (dialect.numbers) return dialect.numbers->listed();
  std::string text;
  for (std::size_t c = 0; c < dialect.columns.size(); ++c) {
    text += fmt::format("{}{} \"{}\"", c == 0 ? "" : ", ", c + 1,
                        base::one_line(dialect.columns[c].text, kLongestShown));
  }
  return text;
}

base::Result<std::size_t> find_column(const Dialect& dialect, const std::string& path,
                                      const std::string& wanted) {
  const std::string form = folded(wanted);
  const auto find = [&](auto&& is_it) -> base::Result<std::optional<std::size_t>> {
    std::optional<std::size_t> found;
    for (std::size_t c = 0; c < dialect.columns.size(); ++c) {
      if (dialect.columns[c].text.empty() || !is_it(dialect.columns[c])) continue;
      if (found) {
        return base::usage_error("{}: columns {} and {} are both called \"{}\": give the number", path,
                                 *found + 1, c + 1, base::one_line(wanted, kLongestShown));
      }
      found = c;
    }
    return found;
  };
  // The path of a dataset may lack its first slash.
  auto found =
      find([&](const ColumnName& column) { return column.text == wanted || column.text == "/" + wanted; });
  if (found && !*found) found = find([&](const ColumnName& column) { return folded(column.text) == form; });
  if (const ColumnName name = column_name(wanted);
      found && !*found && !dialect.numbers && !name.unit.empty()) {
    found = find([&](const ColumnName& column) {
      return folded(column.name) == folded(name.name) && column.unit == name.unit;
    });
  }
  if (found && !*found) {
    // Brackets hold a unit in a heading; behind a variable they choose one of its columns.
    const std::string bare = dialect.numbers ? form : folded(column_name(wanted).name);
    found = find(
        [&](const ColumnName& column) { return folded(column.name) == form || folded(column.name) == bare; });
  }
  if (!found) return tl::unexpected(found.error());
  if (*found) return **found;
  std::size_t number = 0;
  const auto [end, status] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
  if (status == std::errc{} && end == wanted.data() + wanted.size() && number >= 1 &&
      number <= dialect.columns.size()) {
    return number - 1;
  }
  if (dialect.numbers) return tl::unexpected(dialect.numbers->no_column(wanted));
  if (dialect.unclear_heading_line > 0) {
    return base::usage_error(
        "{}:{}: the names of the {} columns have blanks in them and cannot be told apart, so there is no "
        "column "
        "\"{}\": give the number, 1 … {}",
        path, dialect.unclear_heading_line, dialect.columns.size(), base::one_line(wanted, kLongestShown),
        dialect.columns.size());
  }
  if (dialect.header_line == 0 && dialect.labels.empty()) {
    return base::usage_error("{}: the file has no heading, so no column \"{}\": give the number, 1 … {}",
                             path, base::one_line(wanted, kLongestShown), dialect.columns.size());
  }
  return base::usage_error("{}:{}: there is no column \"{}\"; there are {}", path, dialect.header_line,
                           base::one_line(wanted, kLongestShown), listed(dialect));
}

std::optional<std::size_t> time_column_of(const Dialect& dialect, std::size_t value_column) {
  return best_before(dialect, value_column, [&](std::size_t c) { return time_rank(dialect.columns[c]); });
}

std::optional<std::size_t> counter_column_of(const Dialect& dialect, std::size_t value_column) {
  return best_before(dialect, value_column, [&](std::size_t c) {
    return is_scan_counter(dialect.columns[c]) && (dialect.numbers || dialect.numeric[c]) ? 1 : 0;
  });
}

std::int64_t TraceTable::line(std::size_t row) const {
  const auto after =
      std::upper_bound(places.begin(), places.end(), row,
                       [](std::size_t wanted, const auto& place) { return wanted < place.first; });
  if (after == places.begin()) return 0;
  const auto& [first, line] = *std::prev(after);
  return line + static_cast<std::int64_t>(row - first);
}

base::Result<TraceTable> read_table(const Source& source, const Dialect& dialect, std::size_t value_column,
                                    std::optional<std::size_t> time_column,
                                    const std::filesystem::path& scratch_folder) {
  if (dialect.numbers) return dialect.numbers->table(value_column, time_column, scratch_folder);
  return TableReader{source, dialect, value_column, time_column, scratch_folder}.read();
}

}  // namespace stickslip::traces
