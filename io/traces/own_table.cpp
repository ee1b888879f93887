#include "io/traces/own_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "io/fact_line.hpp"

#include "core/base/wording.hpp"
#include "core/record/json_codec.hpp"
#include "core/record/range_check.hpp"

namespace stickslip::traces {
namespace {

using base::Result;

constexpr std::string_view kRemedy =
    "export the record anew, or give --column NAME to read the table as one of another program";

/// What stands behind "# name: "; nothing on another line.
std::optional<std::string_view> fact(std::string_view line, std::string_view name) {
  const std::string begin = fmt::format("# {}: ", name);
  if (!line.starts_with(begin)) return std::nullopt;
  return line.substr(begin.size());
}

std::optional<std::string_view> header_fact(std::string_view line) {
  const auto text = fact(line, io::kHeaderFact);
  return text && text->starts_with('{') ? text : std::nullopt;
}

template <typename Number>
std::optional<Number> number_in(std::string_view text) {
  Number number{};
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (status != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// What stands between the marks, in the vector's own memory: there is a row for each scan.
void part_at(char mark, std::string_view text, std::vector<std::string_view>& parts) {
  parts.clear();
  while (true) {
    const std::size_t at = text.find(mark);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return;
    text.remove_prefix(at + 1);
  }
}

record::ClockAnchor anchor_from(std::string_view text) {
  std::vector<std::string_view> parts;
  part_at(' ', text, parts);
  std::vector<std::int64_t> numbers;
  for (const std::string_view part : parts) {
    if (const auto number = number_in<std::int64_t>(part)) numbers.push_back(*number);
  }
  if (parts.size() != 3 || numbers.size() != 3) throw std::invalid_argument("three whole numbers are needed");
  return record::range_checked(record::ClockAnchor{numbers[0], numbers[1], numbers[2]});
}

std::string_view raw_column(daq::RawQuantity quantity) noexcept {
  switch (quantity) {
    case daq::RawQuantity::kCounts:
      return "counts";
    case daq::RawQuantity::kVolts:
      return "voltage_V";
    case daq::RawQuantity::kForce_N:
      return "force_N";
    case daq::RawQuantity::kCoefficient:
      break;
  }
  return "coefficient";
}

class OwnReader {
 public:
  OwnReader(const std::string& path, const std::filesystem::path& scratch_folder)
      : path_(path), scans_(std::make_shared<record::ScanColumns>(scratch_folder)) {}

  Result<ImportedTest> read(TextFile& file) {
    std::string line;
    while (true) {
      const auto more = file.next(line);
      if (!more) return tl::unexpected(more.error());
      if (!*more) break;
      line_ = file.line_number();
      if (line.empty()) continue;
      const auto taken = line.front() == '#' ? take_fact(line)
                         : columns_ == 0     ? take_heading(line)
                                             : take_row(line);
      if (!taken) return tl::unexpected(taken.error());
    }
    if (!record_.end) {
      return base::usage_error("{}:{}: the table is cut: its last line begins with \"# {}:\"; {}", path_,
                               line_, io::kEndFact, kRemedy);
    }
    if (const auto whole = check_rows(); !whole) return tl::unexpected(whole.error());
    record::ProcessFacts& process = record_.header.process;
    process.source_file = std::filesystem::path{path_}.filename().string();
    process.source_size = static_cast<std::int64_t>(file.bytes_read());
    process.source_sha256 = file.sha256();
    process.source_reading =
        fmt::format("recognised: a table of stickslip export, {} scans\n", scans_->scan.size());
    return ImportedTest{std::move(record_), {scans_, 0, scans_->scan.size()}};
  }

 private:
  Result<void> take_fact(std::string_view line) {
    std::string_view name;
    try {
      if (const auto header = header_fact(line)) {
        name = io::kHeaderFact;
        if (has_header_ || columns_ > 0) throw std::invalid_argument("it stands once, above the table");
        has_header_ = true;
        record_.header = record::header_from_json(io::fact_json(*header));
        const double rate_Hz = record_.header.board.scan_rate_granted_Hz;
        if (!(rate_Hz > 0.0) || !std::isfinite(rate_Hz))
          throw std::invalid_argument(fmt::format("scan_rate_granted {} must be positive", rate_Hz));
      } else if (columns_ == 0) {
        return {};  // The other facts above the table are for people.
      } else if (const auto gap = fact(line, name = io::kGapFact)) {
        record_.gaps.push_back(record::gap_from_json(io::fact_json(*gap)));
        gap_lines_.emplace_back(record_.gaps.back(), line_);
      } else if (const auto event = fact(line, name = io::kEventFact)) {
        record_.events.push_back(record::event_from_json(io::fact_json(*event)));
      } else if (const auto anchor = fact(line, name = io::kAnchorFact)) {
        record_.anchors.push_back(anchor_from(*anchor));
      } else if (const auto scans = fact(line, name = io::kScansFact)) {
        row_count_ = number_in<std::size_t>(*scans);
        if (!row_count_) throw std::invalid_argument("a whole number is needed");
      } else if (const auto end = fact(line, name = io::kEndFact)) {
        const std::string json = io::fact_json(*end);
        record_.end = record::end_from_bytes(std::as_bytes(std::span{json}));
      }
    } catch (const std::exception& error) {
      return base::usage_error("{}:{}: the line \"# {}: …\" cannot be read: {}; {}", path_, line_, name,
                               base::reason_of(error), kRemedy);
    }
    return {};
  }

  Result<void> take_heading(std::string_view line) {
    part_at(',', line, fields_);
    columns_ = fields_.size();
    const auto find = [&names = fields_](std::string_view name) -> std::optional<std::size_t> {
      const auto at = std::find(names.begin(), names.end(), name);
      if (at == names.end()) return std::nullopt;
      return static_cast<std::size_t>(at - names.begin());
    };
    const auto scan = find("scan");
    raw_name_ = raw_column(record_.header.board.quantity);
    const auto raw = find(raw_name_);
    const auto spike = find("spike");
    if (!scan || !raw || !spike) {
      return base::usage_error("{}:{}: there is no column \"{}\"; {}", path_, line_,
                               !scan  ? "scan"
                               : !raw ? raw_name_
                                      : "spike",
                               kRemedy);
    }
    scan_ = *scan;
    raw_ = *raw;
    spike_ = *spike;
    if (const auto& second = record_.header.board.second) {
      second_name_ = fmt::format("{}_counts", daq::name(second->quantity));
      second_ = find(second_name_);
    }
    return {};
  }

  [[nodiscard]] tl::unexpected<base::Error> refused(std::string_view column, std::string_view text,
                                                    std::string_view needed) const {
    return base::usage_error("{}:{}: column \"{}\" is '{}': {} is needed; {}", path_, line_, column,
                             base::one_line(text, 40), needed, kRemedy);
  }

  Result<void> take_row(std::string_view line) {
    if (record_.end) {
      return base::usage_error("{}:{}: a row stands below the line \"# {}: …\", which is the last one; {}",
                               path_, line_, io::kEndFact, kRemedy);
    }
    part_at(',', line, fields_);
    if (fields_.size() != columns_) {
      return base::usage_error("{}:{}: the row has {} fields, the heading {}; {}", path_, line_,
                               fields_.size(), columns_, kRemedy);
    }
    const daq::BoardInfo& board = record_.header.board;
    const auto scan = number_in<std::int64_t>(fields_[scan_]);
    const std::int64_t first = scans_->scan.empty() ? 0 : scans_->scan.back() + 1;
    if (!scan || *scan < first || *scan > record::kLastScan)
      return refused("scan", fields_[scan_],
                     fmt::format("a whole number of {} … {}", first, record::kLastScan));
    const auto raw = number_in<double>(fields_[raw_]);
    if (!raw || !std::isfinite(*raw)) return refused(raw_name_, fields_[raw_], "a finite number");
    if (board.quantity == daq::RawQuantity::kCounts &&
        (*raw != std::floor(*raw) || *raw < 0.0 || *raw > static_cast<double>(board.maxdata)))
      return refused(raw_name_, fields_[raw_], fmt::format("a whole number of 0 … {}", board.maxdata));
    if (fields_[spike_] != "0" && fields_[spike_] != "1") return refused("spike", fields_[spike_], "0 or 1");
    if (second_) {
      const std::string_view text = fields_[*second_];
      const auto code = text.empty() ? daq::SecondChannel::kNoCode : number_in<std::int32_t>(text);
      if (!code || (!text.empty() && *code < 0) || *code > static_cast<std::int64_t>(board.second->maxdata)) {
        return refused(second_name_, text,
                       fmt::format("a whole number of 0 … {}, or nothing", board.second->maxdata));
      }
      scans_->second.push_back(*code);
    }
    if (!scans_->scan.empty() && *scan > first) jumps_.push_back({first, *scan, line_});
    scans_->scan.push_back(*scan);
    scans_->raw.push_back(*raw);
    if (fields_[spike_] == "1") record_.spikes.push_back(*scan);
    return {};
  }

  /// Refuses a table that lacks rows: each scan between two rows is in a gap, and no row is.
  Result<void> check_rows() {
    const base::LongColumn<daq::ScanIndex>& scans = scans_->scan;
    std::ranges::stable_sort(gap_lines_, {}, [](const auto& gap) { return gap.first.first; });
    for (const auto& [gap, line] : gap_lines_) {
      const auto row = std::ranges::lower_bound(scans, gap.first);
      if (row == scans.end() || *row - gap.first >= gap.count) continue;
      return base::usage_error("{}:{}: scan {} is missing by this line, and the table has a row of it; {}",
                               path_, line, *row, kRemedy);
    }
    auto gap = gap_lines_.begin();
    for (const Jump& jump : jumps_) {
      daq::ScanIndex known = jump.first;  // The scans before are in gaps.
      for (; gap != gap_lines_.end() && gap->first.first < jump.end; ++gap) {
        if (gap->first.first <= known) known = std::max(known, gap->first.first + gap->first.count);
      }
      if (known >= jump.end) continue;
      return base::usage_error(
          "{}:{}: the rows of scans {} … {} are missing, and no line \"# {}: …\" says so; {}", path_,
          jump.line, known, jump.end - 1, io::kGapFact, kRemedy);
    }
    if (row_count_ ? scans.size() != *row_count_ : scans.empty()) {
      return base::usage_error("{}: rows are missing: the table has {}{}; {}", path_, scans.size(),
                               row_count_ ? fmt::format(" of {}", *row_count_) : "", kRemedy);
    }
    return {};
  }

  /// Scans [first, end) have no row.
  struct Jump {
    daq::ScanIndex first = 0;
    daq::ScanIndex end = 0;
    std::int64_t line = 0;  ///< Of the row after them.
  };

  std::string path_;
  record::Record record_;
  std::shared_ptr<record::ScanColumns> scans_;
  std::vector<std::pair<daq::Gap, std::int64_t>> gap_lines_;  ///< Gaps with their lines.
  std::vector<Jump> jumps_;
  std::optional<std::size_t> row_count_;  ///< As the table states it; older ones do not.
  std::int64_t line_ = 0;
  bool has_header_ = false;
  std::size_t columns_ = 0;  ///< 0: the heading has not come yet.
  std::size_t scan_ = 0;
  std::size_t raw_ = 0;
  std::size_t spike_ = 0;
  std::optional<std::size_t> second_;
  std::string_view raw_name_;
  std::string second_name_;
  std::vector<std::string_view> fields_;
};

}  // namespace

Result<bool> is_own_table(const Source& source) {
  auto file = TextFile::open(source, std::nullopt);
  if (!file) return tl::unexpected(file.error());
  std::string line;
  while (true) {
    const auto more = file->next(line);
    if (!more) return tl::unexpected(more.error());
    if (!*more || !line.starts_with('#')) return false;
    if (header_fact(line)) return true;
  }
}

Result<ImportedTest> read_own_table(const Source& source, const std::filesystem::path& scratch_folder) {
  auto file = TextFile::open(source, std::nullopt);
  if (!file) return tl::unexpected(file.error());
  return OwnReader{source.path, scratch_folder}.read(*file);
}

}  // namespace stickslip::traces
