#include "core/record/csv_table.hpp"

#include <csv.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <string_view>

#include "core/base/wording.hpp"
#include "core/record/file.hpp"

namespace stickslip::record {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // Spreadsheets put it in front of UTF-8.
/// Of a bad value shown in a message.
constexpr std::size_t kLongestShown = 40;

std::string shown(std::string_view text) {
  return text.size() <= kLongestShown ? fmt::format("'{}'", text)
                                      : fmt::format("'{}…'", text.substr(0, kLongestShown));
}

/// Counts the digits of a printed number, as CsvColumn needs them.
void count_digits(std::string_view text, CsvColumn& column) {
  int decimals = 0;
  int significant = 0;
  bool point_seen = false;
  bool nonzero_seen = false;
  std::size_t i = 0;
  for (; i < text.size() && text[i] != 'e' && text[i] != 'E'; ++i) {
    if (text[i] == '.') {
      point_seen = true;
    } else if (text[i] >= '0' && text[i] <= '9') {
      nonzero_seen = nonzero_seen || text[i] != '0';
      significant += nonzero_seen ? 1 : 0;
      decimals += point_seen ? 1 : 0;
    }
  }
  if (i + 1 < text.size()) {
    const char* begin = text.data() + i + 1;
    if (*begin == '+') ++begin;
    int exponent = 0;
    std::from_chars(begin, text.data() + text.size(), exponent);
    decimals -= exponent;
  }
  column.decimals = std::max(column.decimals, decimals);
  column.significant_digits = std::max(column.significant_digits, significant);
}

/// What a refusal quotes of the file may have any length, and line breaks between quotes.
constexpr std::size_t kLongestRefusal = 400;

/// Collects rows while libcsv finds fields. Errors wait in `error`: nothing may be thrown through C.
class Collector {
 public:
  Collector(const std::filesystem::path& path, const std::string& column,
            const std::vector<std::string>& time_columns)
      : path_(path.string()), time_columns_(time_columns) {
    table_.values.name = column;
  }

  void field(std::string_view text) {
    if (!header_read_) {
      header_.emplace_back(text);
    } else if (column_ == field_) {
      number(text, table_.values);
    } else if (time_column_ == field_) {
      number(text, table_.time);
    }
    ++field_;
  }

  void row_end() {
    if (error_) return;
    if (!header_read_) {
      header_end();
    } else if (field_ != header_.size()) {
      refuse("row has {} fields, the header has {}: mend the row", field_, header_.size());
    } else if (empty_line_ > 0) {
      line_ = empty_line_;
      refuse("line is empty between rows: remove it");
    } else {
      table_.line.push_back(line_);
    }
    field_ = 0;
  }

  void line_begins(bool empty) {
    ++line_;
    if (empty && empty_line_ == 0) empty_line_ = line_;
  }

  template <typename... Args>
  void refuse(fmt::format_string<Args...> format, Args&&... args) {
    if (error_) return;
    error_ = base::Error{
        base::ErrorKind::kUsage,
        fmt::format("{}:{}: {}", path_, line_,
                    base::one_line(fmt::format(format, std::forward<Args>(args)...), kLongestRefusal))};
  }

  [[nodiscard]] const std::optional<base::Error>& error() const { return error_; }
  [[nodiscard]] bool before_header() const { return !header_read_ && header_.empty(); }

  [[nodiscard]] base::Result<CsvTable> result() && {
    if (error_) return tl::unexpected(*error_);
    if (!header_read_) return base::usage_error("{}: is empty: a header line and rows are needed", path_);
    if (table_.line.empty())
      return base::usage_error("{}:{}: there are no rows after the header", path_, line_);
    return std::move(table_);
  }

 private:
  void header_end() {
    header_read_ = true;
    column_ = find(table_.values.name);
    if (column_ == header_.size()) {
      refuse("there is no column '{}'; there are: {}", table_.values.name, fmt::join(header_, ", "));
    }
    time_column_ = header_.size();
    for (const auto& name : time_columns_) {
      if (time_column_ == header_.size() && name != table_.values.name) {
        time_column_ = find(name);
        if (time_column_ != header_.size()) table_.time.name = name;
      }
    }
  }

  std::size_t find(const std::string& name) {
    if (std::count(header_.begin(), header_.end(), name) > 1) {
      refuse("there are several columns '{}': rename all but one", name);
    }
    return static_cast<std::size_t>(std::find(header_.begin(), header_.end(), name) - header_.begin());
  }

  void number(std::string_view text, CsvColumn& column) {
    if (error_) return;
    std::string_view digits = text;
    if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
    double value = 0.0;
    const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (digits.empty() || end != digits.data() + digits.size() || status == std::errc::invalid_argument) {
      return refuse("column '{}' is {}: a number is needed, with a point for decimals", column.name,
                    shown(text));
    }
    if (status != std::errc{} || !std::isfinite(value)) {
      return refuse("column '{}' is {}: a finite number is needed; cut the trace where it has none",
                    column.name, shown(text));
    }
    count_digits(digits, column);
    column.values.push_back(value);
  }

  std::string path_;
  const std::vector<std::string>& time_columns_;
  CsvTable table_;
  std::vector<std::string> header_;
  bool header_read_ = false;
  std::size_t column_ = 0;
  std::size_t time_column_ = 0;
  std::size_t field_ = 0;
  std::int64_t line_ = 0;
  std::int64_t empty_line_ = 0;  ///< First one seen; 0 if none.
  std::optional<base::Error> error_;
};

void on_field(void* text, std::size_t size, void* collector) {
  static_cast<Collector*>(collector)->field(
      text == nullptr ? std::string_view{} : std::string_view{static_cast<const char*>(text), size});
}

void on_row_end(int /*character*/, void* collector) { static_cast<Collector*>(collector)->row_end(); }

}  // namespace

double CsvColumn::resolution(double value) const {
  const double by_decimals = std::pow(10.0, -decimals);
  if (value == 0.0) return by_decimals;
  const double magnitude = std::floor(std::log10(std::abs(value)));
  return std::max(by_decimals, std::pow(10.0, magnitude + 1.0 - significant_digits));
}

base::Result<CsvTable> read_csv_table(const std::filesystem::path& path, const std::string& column,
                                      const std::vector<std::string>& time_columns) {
  const auto file = read_file(path);
  if (!file) return tl::unexpected(file.error());
  std::string_view rest{reinterpret_cast<const char*>(file->data()), file->size()};
  if (rest.substr(0, kByteOrderMark.size()) == kByteOrderMark) rest.remove_prefix(kByteOrderMark.size());

  csv_parser parser{};
  if (csv_init(&parser, CSV_STRICT | CSV_STRICT_FINI) != 0) return base::failure("libcsv: cannot begin");
  const std::unique_ptr<csv_parser, void (*)(csv_parser*)> owner{&parser, csv_free};
  Collector collector{path, column, time_columns};
  // Line by line, so that whoever finds an error knows the line.
  while (!rest.empty() && !collector.error()) {
    const std::size_t newline = rest.find('\n');
    const std::string_view line = rest.substr(0, newline == std::string_view::npos ? newline : newline + 1);
    collector.line_begins(line == "\n" || line == "\r\n");
    // What `stickslip export` and others tell of the data before the header.
    if (collector.before_header() && line.front() == '#') {
      rest.remove_prefix(line.size());
      continue;
    }
    if (csv_parse(&parser, line.data(), line.size(), on_field, on_row_end, &collector) != line.size()) {
      collector.refuse(
          "{}", csv_error(&parser) == CSV_EPARSE
                    ? "a quote stands where none may: \"…\" encloses a whole field, \"\" is a quote in it"
                    : csv_strerror(csv_error(&parser)));
    }
    rest.remove_prefix(line.size());
  }
  if (!collector.error() && csv_fini(&parser, on_field, on_row_end, &collector) != 0) {
    collector.refuse("a quoted field does not end: the file is cut short or a quote is missing");
  }
  return std::move(collector).result();
}

}  // namespace stickslip::record
