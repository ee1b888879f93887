#include "io/traces/number_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <span>
#include <string_view>
#include <utility>
#include <variant>

#include "io/traces/matlab_file.hpp"
#include "io/traces/trace_table.hpp"

#include "core/base/nan.hpp"
#include "core/base/regular_file.hpp"
#include "core/base/sanitized.hpp"
#include "core/base/shell_word.hpp"
#include "core/base/wording.hpp"
#include "core/record/file.hpp"
#include "core/record/hdf_columns.hpp"
#include "core/record/sha256.hpp"

namespace stickslip::traces {
namespace {

using record::NumberColumn;

constexpr std::size_t kBeginning = 4096;
constexpr std::size_t kLongestColumn = 60;
/// Names of columns in one line.
constexpr std::size_t kMostListed = 20;

// The first letter of an answer.
constexpr char kRead = '+';
constexpr char kUsage = 'u';    ///< The message follows.
constexpr char kFailure = 'f';  ///< The message follows.
/// Between the parts of an answer; no name has it.
constexpr char kEnd = '\0';

bool is_hdf5(std::string_view head) {
  // ["HDF5 File Format Specification", II.A]
  constexpr std::string_view kSignature = "\x89HDF\r\n\x1A\n";
  for (std::size_t at = 0; at < head.size(); at = at == 0 ? 512 : 2 * at) {
    if (head.substr(at).starts_with(kSignature)) return true;
  }
  return false;
}

std::string refusal(const base::Error& error) {
  return (error.kind == base::ErrorKind::kUsage ? kUsage : kFailure) + error.message;
}

/// In the child, where the file stays open between two questions.
class Reader {
 public:
  Reader(const Source& source, bool is_hdf5) : path_(source.opened), shown_(source.path), is_hdf5_(is_hdf5) {}

  /// \param question  empty: the format and all columns; else the number of a column, whose values go to the
  /// memory file.
  std::string answer(std::string_view question, int memory_file) {
    if (std::holds_alternative<std::monostate>(file_)) {
      if (auto opened = open(); !opened) return refusal(opened.error());
    }
    const auto* matlab = std::get_if<MatlabColumns>(&file_);
    const std::vector<NumberColumn>& columns =
        matlab != nullptr ? matlab->columns() : std::get<record::HdfColumns>(file_).columns();
    if (question.empty()) {
      std::string text = kRead + (matlab != nullptr ? matlab->format() : std::string{"HDF5"}) + kEnd;
      for (const NumberColumn& column : columns) {
        for (const std::string& part : {column.path, column.dataset, column.part, column.unit, column.why}) {
          text += part;
          text += kEnd;
        }
        text += fmt::format("{}{}{}{}", column.size, kEnd, column.single ? 1 : 0, kEnd);
      }
      return text;
    }
    std::size_t place = 0;
    std::from_chars(question.data(), question.data() + question.size(), place);
    if (place >= columns.size()) return kFailure + std::string{"has changed while it was read"};
    const auto values = matlab != nullptr ? std::get<MatlabColumns>(file_).read(columns[place])
                                          : std::get<record::HdfColumns>(file_).read(columns[place]);
    if (!values) return refusal(values.error());
    const auto bytes = std::as_bytes(std::span{*values});
    if (record::write_all(memory_file, bytes, record::system_calls()) != bytes.size())
      return fmt::format("{}cannot be read: {}", kFailure, base::system_message(errno));
    return std::string{kRead};
  }

 private:
  base::Result<void> open() {
    if (!base::kSanitized) {
      // What its libraries print when they die would be a second message.
      const base::Descriptor nowhere{::open("/dev/null", O_WRONLY | O_CLOEXEC)};
      ::dup2(nowhere.get(), STDERR_FILENO);
    }
    ::setenv("HDF5_USE_FILE_LOCKING", "BEST_EFFORT", 0);  // NOLINT: one thread.
    if (is_hdf5_) {
      auto opened = record::HdfColumns::open(path_);
      if (!opened) return tl::unexpected(opened.error());
      if (opened->is_record()) {
        return base::usage_error(
            "is a record of stickslip already, which needs no import: stickslip analyze {}",
            base::shell_word(shown_));
      }
      file_ = *std::move(opened);
    } else {
      auto opened = MatlabColumns::open(path_);
      if (!opened) return tl::unexpected(opened.error());
      file_ = *std::move(opened);
    }
    return {};
  }

  std::string path_;
  std::string shown_;  ///< Of the path, in a command for the user.
  bool is_hdf5_;
  std::variant<std::monostate, MatlabColumns, record::HdfColumns> file_;
};

/// Of all bytes, by blocks.
base::Result<std::pair<std::uint64_t, std::string>> size_and_sha256(const Source& source) {
  constexpr std::size_t kBlock = std::size_t{1} << 18U;
  const auto opened = base::open_text(source.opened);
  if (!opened) return tl::unexpected(opened.error());
  record::Sha256 sha256;
  std::uint64_t size = 0;
  std::vector<char> block(kBlock);
  while (true) {
    const ssize_t got = ::read(opened->file.get(), block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return base::failure("{}: cannot be read: {}", source.path, base::system_message(errno));
    if (got == 0) return std::pair{size, sha256.hexadecimal()};
    sha256.add(std::span<const char>{block.data(), static_cast<std::size_t>(got)});
    size += static_cast<std::uint64_t>(got);
  }
}

/// What holds a column in HDF5, where names of datasets may have points, or else in MATLAB.
constexpr const char* kMarks = "/";
constexpr const char* kMatlabMarks = "./";

/// Where the column's own name begins, less 1; npos: nothing holds it.
std::size_t mark_of(const NumberColumn& column, bool is_hdf5) {
  if (!column.dataset.empty()) return column.dataset.size();
  return column.path.find_last_of(is_hdf5 ? kMarks : kMatlabMarks);
}

/// The group, compound or struct that holds a column.
std::string_view group_of(const NumberColumn& column, bool is_hdf5) {
  const std::size_t mark = mark_of(column, is_hdf5);
  return mark == std::string::npos ? std::string_view{} : std::string_view{column.path}.substr(0, mark);
}

/// Some of many, in one line.
std::string first_of(const std::vector<std::string>& shown) {
  const std::size_t count = std::min(kMostListed, shown.size());
  std::string text =
      fmt::format("{}", fmt::join(shown.begin(), shown.begin() + static_cast<std::ptrdiff_t>(count), ", "));
  if (shown.size() > count) text += fmt::format(", and {} more", shown.size() - count);
  return text;
}

/// Digits behind the point with which the times are written at their shortest, as a text would have them.
int decimals_of(const std::vector<double>& time, bool single) {
  double largest = 0.0;
  for (const double value : time) {
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  }
  const double step =
      largest * (single ? std::numeric_limits<float>::epsilon() : std::numeric_limits<double>::epsilon());
  const int most = step > 0.0 ? std::max(0, static_cast<int>(std::floor(-std::log10(step)))) : 0;
  int decimals = 0;
  for (const double value : time) {
    if (decimals >= most) return most;
    const std::string text = single ? fmt::format("{}", static_cast<float>(value)) : fmt::format("{}", value);
    decimals = std::max(decimals, read_cell(text, '.').decimals);
  }
  return std::min(decimals, most);
}

}  // namespace

NumberFile::NumberFile(const Source& source, bool is_hdf5)
    : path_(source.path),
      is_hdf5_(is_hdf5),
      child_(base::ChildWork{
          [reader = std::make_shared<Reader>(source, is_hdf5)](std::string_view question, int memory_file) {
            return reader->answer(question, memory_file);
          }}) {}

base::Result<std::unique_ptr<NumberFile>> NumberFile::open(const Source& source) {
  const auto head = base::read_text(source.opened, kBeginning);
  if (!head) return tl::unexpected(head.error());
  const bool matlab = is_matlab(*head);
  const bool hdf5 = traces::is_hdf5(*head);
  if (!matlab && !hdf5) return nullptr;
  if (matlab && hdf5 && source.copy.open()) {
    return base::usage_error("{}: is a file of MATLAB 7.3, which cannot be read from a pipe: give its name",
                             source.path);
  }
  auto facts = size_and_sha256(source);
  if (!facts) return tl::unexpected(facts.error());
  std::unique_ptr<NumberFile> file{new NumberFile{source, !matlab}};
  std::tie(file->file_size_, file->sha256_) = *std::move(facts);
  if (auto listed = file->list(); !listed) return tl::unexpected(listed.error());
  return file;
}

base::Result<std::string> NumberFile::ask(const std::string& question) {
  auto answer = child_.ask(question, base::limits_for_file(file_size_));
  if (!answer) {
    if (answer.error().kind != base::ErrorKind::kUsage)
      return tl::unexpected(
          base::Error{answer.error().kind, fmt::format("{}: {}", path_, answer.error().message)});
    return base::usage_error(
        "{}: {}: the file is damaged or was made to do harm; restore it from a backup, or export the trace "
        "as text",
        path_, answer.error().message);
  }
  if (answer->empty() || answer->front() != kRead) {
    const std::string message = answer->empty() ? "cannot be read" : answer->substr(1);
    const auto kind = answer->starts_with(kUsage) ? base::ErrorKind::kUsage : base::ErrorKind::kFailure;
    return tl::unexpected(base::Error{kind, fmt::format("{}: {}", path_, message)});
  }
  return answer->substr(1);
}

base::Result<void> NumberFile::list() {
  const auto answer = ask({});
  if (!answer) return tl::unexpected(answer.error());
  std::string_view rest = *answer;
  const auto next = [&rest] {
    const std::size_t end = std::min(rest.find(kEnd), rest.size());
    const std::string part{rest.substr(0, end)};
    rest.remove_prefix(std::min(end + 1, rest.size()));
    return part;
  };
  format_ = next();
  for (std::size_t place = 0; !rest.empty(); ++place) {
    NumberColumn column;
    column.path = next();
    column.dataset = next();
    column.part = next();
    column.unit = next();
    column.why = next();
    const std::string size = next();
    std::from_chars(size.data(), size.data() + size.size(), column.size);
    column.single = next() == "1";
    if (column.why.empty()) {
      places_.push_back(place);
      columns_.push_back(std::move(column));
    } else {
      refused_.push_back(std::move(column));
    }
  }
  if (columns_.empty()) {
    return base::usage_error("{}: is a file of {} without a vector of numbers{}", path_, format_,
                             refused_.empty() ? "" : ": " + refused());
  }
  return {};
}

std::string NumberFile::name(std::size_t column) const {
  return columns_[column].path + columns_[column].part;
}

std::string NumberFile::called(std::size_t column) const {
  return fmt::format("{} {}", is_hdf5_ ? "dataset" : "variable",
                     base::one_line(name(column), kLongestColumn));
}

ColumnName NumberFile::column_name(std::size_t column) const {
  const NumberColumn& own = columns_[column];
  // Of npos, 0.
  ColumnName result = traces::column_name(own.path.substr(mark_of(own, is_hdf5_) + 1), own.unit);
  result.text = name(column);
  result.name += own.part;
  return result;
}

std::optional<int> NumberFile::nearness(std::size_t column, std::size_t other) const {
  if (columns_[column].size != columns_[other].size) return std::nullopt;
  const std::string_view group = group_of(columns_[column], is_hdf5_);
  const std::string_view others = group_of(columns_[other], is_hdf5_);
  if (!others.starts_with(group)) return std::nullopt;
  const std::string_view marks = is_hdf5_ ? kMarks : kMatlabMarks;
  if (!group.empty() && others != group && marks.find(others[group.size()]) == std::string_view::npos)
    return std::nullopt;
  return static_cast<int>(group.size());
}

std::string NumberFile::refused() const {
  std::vector<std::string> shown;
  for (const NumberColumn& column : refused_)
    shown.push_back(fmt::format("{} {}", base::one_line(column.path, kLongestColumn), column.why));
  return first_of(shown);
}

std::string NumberFile::listed() const {
  std::vector<std::string> shown;
  for (std::size_t c = 0; c < columns_.size(); ++c)
    shown.push_back(fmt::format("{} \"{}\"", c + 1, base::one_line(name(c), kLongestColumn)));
  return first_of(shown);
}

std::string NumberFile::of_other_size(std::size_t column) const {
  const auto with_size = [this](std::size_t c) {
    return fmt::format("{} ({})", base::one_line(name(c), kLongestColumn), size(c));
  };
  std::vector<std::string> shown;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (size(c) != size(column)) shown.push_back(with_size(c));
  }
  return shown.empty() ? std::string{} : with_size(column) + ": " + first_of(shown);
}

base::Error NumberFile::no_column(const std::string& wanted) const {
  const auto found = std::find_if(refused_.begin(), refused_.end(), [&](const NumberColumn& column) {
    return column.path == wanted || column.path == "/" + wanted;
  });
  const std::string shown = base::one_line(wanted, kLongestColumn);
  const std::string what = found == refused_.end() ? fmt::format("there is no column \"{}\"", shown)
                                                   : fmt::format("\"{}\" {}", shown, found->why);
  return {base::ErrorKind::kUsage, fmt::format("{}: {}; vectors of numbers are {}", path_, what, listed())};
}

base::Result<std::vector<double>> NumberFile::read(std::size_t column) {
  const auto answer = ask(std::to_string(places_[column]));
  if (!answer) return tl::unexpected(answer.error());
  std::vector<double> values(columns_[column].size);
  std::ifstream file{child_.memory_file(), std::ios::binary};
  if (!file.read(reinterpret_cast<char*>(values.data()),
                 static_cast<std::streamsize>(values.size() * sizeof(double))))
    return base::failure("{}: the values that the reading process hands over cannot be read", path_);
  return values;
}

base::Result<TraceTable> NumberFile::table(std::size_t value_column, std::optional<std::size_t> time_column,
                                           const std::filesystem::path& scratch_folder) {
  if (time_column && size(*time_column) != size(value_column)) {
    return base::usage_error(
        "{}: \"{}\" has {} values, \"{}\" {}: choose columns of one length, or give --time-column none and "
        "--rate HZ",
        path_, base::one_line(name(*time_column), kLongestColumn), size(*time_column),
        base::one_line(name(value_column), kLongestColumn), size(value_column));
  }
  auto values = read(value_column);
  if (!values) return tl::unexpected(values.error());
  TraceTable table{scratch_folder};
  table.sha256 = sha256_;
  table.size = file_size_;
  for (double& value : *values) {
    if (!std::isfinite(value)) value = base::kNaN;
  }
  table.places.emplace_back(0, 1);
  if (!time_column) {
    for (const double value : *values) table.value.push_back(value);
    return table;
  }
  auto time = read(*time_column);
  if (!time) return tl::unexpected(time.error());
  table.time_decimals = decimals_of(*time, columns_[*time_column].single);
  for (std::size_t row = 0; row < time->size(); ++row) {
    const double at = (*time)[row];
    const double value = (*values)[row];
    const std::size_t kept = table.value.size();
    if (!std::isfinite(at)) {
      if (std::isnan(value)) continue;  // A row that is none.
      return base::usage_error(
          "{}:{}: \"{}\" has no time beside the value {}: give --time-column none and --rate HZ if the scans "
          "are evenly spaced",
          path_, row + 1, base::one_line(name(*time_column), kLongestColumn), value);
    }
    if (kept == 0) table.first_time = at;
    if (const auto place = static_cast<std::int64_t>(row) + 1; table.line(kept) != place)
      table.places.emplace_back(kept, place);
    table.time.push_back(at - table.first_time);
    table.value.push_back(value);
  }
  return table;
}

}  // namespace stickslip::traces
