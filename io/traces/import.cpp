#include "io/traces/import.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <utility>

#include "io/traces/cut.hpp"
#include "io/traces/grid.hpp"
#include "io/traces/inspect.hpp"
#include "io/traces/own_table.hpp"
#include "io/traces/quantity_unit.hpp"
#include "io/traces/time_unit.hpp"
#include "io/traces/trace_table.hpp"

#include "core/base/nan.hpp"
#include "core/base/text.hpp"
#include "core/base/wording.hpp"
#include "core/daq/calibration.hpp"
#include "core/pipeline/segmenter.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::traces {
namespace {

using base::Result;
using daq::RawQuantity;

/// More holes than this part of the scans are refused: it is another column that has the force.
constexpr double kMostHoles = 0.5;
/// The force counts as that of sliding above this part of its largest value.
constexpr double kSlidingShare = 0.5;
/// Values above all but this part of the scans are left to spikes when the largest is sought.
constexpr double kSpikeShare = 0.01;

/// The columns that a request means.
struct Columns {
  std::size_t value = 0;
  std::optional<std::size_t> time;
  bool counts_scans = false;  ///< The time column has indices of scans.
};

Result<Columns> columns_of(const ImportRequest& request, const Dialect& dialect) {
  Columns columns;
  const auto value = find_column(dialect, request.path, request.column);
  if (!value) return tl::unexpected(value.error());
  columns.value = *value;
  if (request.time_column == "none") return columns;
  if (!request.time_column.empty()) {
    const auto time = find_column(dialect, request.path, request.time_column);
    if (!time) return tl::unexpected(time.error());
    columns.time = *time;
    return columns;
  }
  columns.time = time_column_of(dialect, columns.value);
  if (!columns.time && request.rate_Hz) {
    columns.time = counter_column_of(dialect, columns.value);
    columns.counts_scans = columns.time.has_value();
  }
  return columns;
}

/// The unit of the values, stated, of the cells or of the heading.
Result<std::string> unit_of(const ImportRequest& request, const ColumnName& column,
                            const std::string& cell_unit) {
  const std::string& own = cell_unit.empty() ? column.unit : cell_unit;
  if (request.unit.empty()) {
    if (!own.empty() && quantity_unit(own)) return own;
    if (!own.empty()) {
      return base::usage_error("{}: column \"{}\" is in {}, which is no unit of force: {}", request.path,
                               base::one_line(column.text, 40), base::one_line(own, 20),
                               quantity_unit(force_unit(own)) ? "give --unit " + force_unit(own)
                               : is_unit(own)                 ? "choose another column"
                                              : "give --unit, such as N, mN, gf, V or coefficient");
    }
    return base::usage_error(
        "{}: column \"{}\" does not say its unit: give --unit, such as N, mN, gf, V or coefficient",
        request.path, base::one_line(column.text, 40));
  }
  const auto stated = quantity_unit(request.unit);
  const auto found = quantity_unit(force_unit(own));
  if (!own.empty() && stated && !found && is_unit(own)) {
    return base::usage_error("{}: column \"{}\" is in {}, which --unit {} is not: choose another column",
                             request.path, base::one_line(column.text, 40), base::one_line(own, 20),
                             request.unit);
  }
  if (!own.empty() && stated && found &&
      (stated->quantity != found->quantity || stated->scale != found->scale)) {
    return base::usage_error("{}: column \"{}\" is in {}, --unit says {}: give --unit {}", request.path,
                             base::one_line(column.text, 40), base::one_line(own, 20), request.unit,
                             base::one_line(force_unit(own), 20));
  }
  return request.unit;
}

/// Values at equal intervals, by linear interpolation between rows; none across a hole or a missing row.
void resample(double rate_Hz, const RowView& time, const RowView& value, record::ScanColumns& scans) {
  const double step = 1.0 / rate_Hz;
  std::size_t right = 1;
  const double end = time.back() + 1e-9 * step;
  for (daq::ScanIndex k = 0; static_cast<double>(k) * step <= end - time.front(); ++k) {
    const double at = time.front() + static_cast<double>(k) * step;
    while (right + 1 < time.size() && time[right] < at) ++right;
    const double length = time[right] - time[right - 1];
    if (length > 2.0 * step || !(length > 0.0)) continue;
    const double mean = std::lerp(value[right - 1], value[right], (at - time[right - 1]) / length);
    if (!std::isfinite(mean)) continue;
    scans.scan.push_back(k);
    scans.raw.push_back(mean);
  }
}

/// Rows of equal intervals, without holes and doubled ones.
void take_rows(const Grid& grid, const RowView& value, record::ScanColumns& scans) {
  for (std::size_t row = 0; row < value.size(); ++row) {
    const double at = value[row];
    if (!std::isfinite(at) || (!grid.doubled.empty() && grid.doubled[row])) continue;
    scans.scan.push_back(grid.index[row]);
    scans.raw.push_back(at);
  }
}

/// Scans that are looked at for sliding_level().
constexpr std::size_t kScansForLevel = signal::kMostSorted;

/// Mean coefficient of the scans of sliding, with its sign; spikes do not count. Of long traces it takes
/// scans at equal distances.
double sliding_level(std::size_t all, const std::function<double(std::size_t)>& coefficient) {
  const std::size_t stride = (all - 1) / kScansForLevel + 1;
  const std::size_t count = (all - 1) / stride + 1;
  const auto place = static_cast<std::size_t>((1.0 - kSpikeShare) * static_cast<double>(count - 1));
  const double largest =
      signal::nth_of(count, place, [&](std::size_t i) { return std::abs(coefficient(i * stride)); });
  double sum = 0.0;
  std::size_t sliding = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double c = coefficient(i * stride);
    if (std::abs(c) < kSlidingShare * largest || std::abs(c) > largest) continue;
    sum += c;
    ++sliding;
  }
  return sliding == 0 ? 0.0 : sum / static_cast<double>(sliding);
}

class Importer {
 public:
  Importer(const ImportRequest& request, const Source& source, Dialect dialect)
      : request_(request), source_(source), dialect_(std::move(dialect)) {}

  Result<Imported> import() {
    const auto columns = columns_of(request_, dialect_);
    if (!columns) return tl::unexpected(columns.error());
    columns_ = *columns;
    auto table = read_table(source_, dialect_, columns_.value, columns_.time, request_.scratch_folder);
    if (!table) return tl::unexpected(table.error());
    table_ = std::move(*table);
    row_count_ = table_.value.size();
    Continued counter;
    if (columns_.time && table_.time_decimals <= 0 && !table_.time_in_seconds) {
      counter = continued(std::move(table_.time), table_.first_time, columns_.counts_scans,
                          request_.scratch_folder);
      table_.time = std::move(counter.column);
    }
    if (columns_.counts_scans && !is_count(RowView{table_.time, 0.0, 1.0, false})) {
      note("column \"{}\" is not read: it does not count the rows",
           base::one_line(dialect_.columns[*columns_.time].text, 40));
      columns_.time.reset();
      columns_.counts_scans = false;
    }
    imported_.report = dialect_.text(columns_.value);
    if (row_count_ < 2) {
      return base::usage_error("{}: there {} of scans; two at least are needed", request_.path,
                               row_count_ == 0 ? "are no rows" : "is one row");
    }
    if (!columns_.time && !request_.rate_Hz) {
      return base::usage_error(
          "{}: no column is a time by its name: give --time-column NAME, or --rate HZ if the scans are "
          "evenly spaced",
          request_.path);
    }
    if (auto ok = find_quantity(); !ok) return tl::unexpected(ok.error());
    if (auto ok = check_counts(); !ok) return tl::unexpected(ok.error());
    if (auto ok = find_times(); !ok) return tl::unexpected(ok.error());
    if (request_.reverse) move_start();
    const double offset =
        quantity_ == RawQuantity::kCounts ? static_cast<double>(request_.counts->lowest) : 0.0;
    value_ = RowView{table_.value, offset, scale_, request_.reverse};
    const std::vector<std::size_t> runs = time_s_.empty() ? std::vector<std::size_t>{0} : runs_in(time_s_);
    several_runs_ = runs.size() > 1;
    if (several_runs_)
      note("{} runs: the clock starts again in {} {}", runs.size(), row_word(), line(runs[1]));
    if (columns_.time) tell_starts(counter, *columns_.time);
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const std::size_t end = i + 1 < runs.size() ? runs[i + 1] : row_count_;
      if (auto added = add_run(runs[i], end); !added) return tl::unexpected(added.error());
    }
    for (const std::string& text : table_.notes) note("{}", text);
    return finish();
  }

 private:
  /// In the file, of a row of the trace.
  [[nodiscard]] std::int64_t line(std::size_t row) const {
    return table_.line(request_.reverse ? row_count_ - 1 - row : row);
  }

  template <typename... Args>
  void note(fmt::format_string<Args...> format, Args&&... args) {
    notes_ += fmt::format("{}: {}\n", base::printable(request_.path),
                          fmt::format(format, std::forward<Args>(args)...));
  }

  /// What TraceTable::line() counts.
  [[nodiscard]] const char* row_word() const { return dialect_.numbers ? "row" : "line"; }

  Result<void> find_quantity() {
    const auto unit = unit_of(request_, dialect_.columns[columns_.value], table_.cell_unit);
    if (!unit) return tl::unexpected(unit.error());
    const auto known = quantity_unit(*unit);
    if (!known) return tl::unexpected(known.error());
    unit_ = *unit;
    quantity_ = known->quantity;
    scale_ = known->scale;
    load_cell_ = request_.load_cell;
    const bool counts = quantity_ == RawQuantity::kCounts;
    const bool voltage = counts || quantity_ == RawQuantity::kVolts;
    if (counts && !request_.counts) {
      return base::usage_error(
          "{}: --unit counts needs --count-range and --volts-per-count, such as --count-range 0..65535 "
          "--volts-per-count \"0.3 mV\"",
          request_.path);
    }
    if (!counts && request_.counts)
      return base::usage_error(
          "{}: --count-range and --volts-per-count are for --unit counts, the unit is {}", request_.path,
          unit_);
    if (counts && request_.resample) {
      return base::usage_error(
          "{}: --resample makes numbers between the counts: leave it out, or convert the counts to volts and "
          "give "
          "--unit V",
          request_.path);
    }
    if (voltage && !load_cell_) {
      return base::usage_error("{}: --unit {} needs --load-cell-gain, such as \"2 N/V\"", request_.path,
                               unit_);
    }
    if (!voltage && load_cell_) {
      return base::usage_error(
          "--load-cell-gain and --load-cell-zero are for --unit V, mV and counts only: leave them out");
    }
    if (quantity_ != RawQuantity::kCoefficient && !request_.tester.sled_mass_kg) {
      return base::usage_error(
          "{}: --unit {} needs --sled-mass: a coefficient is force over the sled's weight", request_.path,
          unit_);
    }
    if (request_.invert) {
      if (load_cell_) {
        load_cell_->gain_N_per_V = -load_cell_->gain_N_per_V;
      } else {
        scale_ = -scale_;
      }
    }
    return {};
  }

  /// Refuses values that are no whole numbers of the range stated. value_ counts from the lower rail.
  Result<void> check_counts() const {
    if (quantity_ != RawQuantity::kCounts) return {};
    const auto lowest = static_cast<double>(request_.counts->lowest);
    const auto highest = static_cast<double>(request_.counts->highest);
    for (std::size_t row = 0; row < table_.value.size(); ++row) {
      const double value = table_.value[row];
      if (std::isnan(value) || (value == std::floor(value) && value >= lowest && value <= highest)) continue;
      return base::usage_error(
          "{}:{}: column \"{}\" is {}, and counts are whole numbers of {} … {}: correct {}", request_.path,
          table_.line(row), base::one_line(dialect_.columns[columns_.value].text, 40), value,
          request_.counts->lowest, request_.counts->highest,
          value == std::floor(value) ? "--count-range" : "--unit, or choose another column");
    }
    return {};
  }

  void set_board(daq::BoardInfo& board) const {
    board.quantity = quantity_;
    if (quantity_ != RawQuantity::kCounts) return;
    const CountScale& counts = *request_.counts;
    board.maxdata = static_cast<std::uint32_t>(counts.highest - counts.lowest);
    board.range_min_V = static_cast<double>(counts.lowest) * counts.volts_per_count;
    board.range_max_V = static_cast<double>(counts.highest) * counts.volts_per_count;
    board.polynomial = {0.0, counts.volts_per_count};
    board.expansion_origin = static_cast<double>(-counts.lowest);
  }

  Result<void> find_times() {
    if (!columns_.time) {
      note("no column of times is read: the rate is not checked");
      return {};
    }
    const ColumnName& column = dialect_.columns[*columns_.time];
    grid_options_.rate_Hz = request_.rate_Hz;
    grid_options_.resample = request_.resample;
    grid_options_.skip_doubled = request_.skip_doubled;
    double unit_s = 1.0;
    if (columns_.counts_scans) {
      unit_s = 1.0 / *request_.rate_Hz;
      note("column \"{}\" counts the scans: the rate is not checked", base::one_line(column.text, 40));
    } else {
      const auto unit = time_unit_of(request_, column, table_);
      if (!unit) return tl::unexpected(unit.error());
      unit_s = unit->seconds;
      grid_options_.time_unit = unit->name;
      start_ns_ = start_of(table_, unit_s);
      // Clock times without an offset are up to half a day from UTC.
      constexpr std::int64_t kDay_ns = 86'400'000'000'000;
      if (start_ns_ && request_.now_ns && *start_ns_ > *request_.now_ns + kDay_ns) {
        note("no start time: by the time column it lies in the future");
        start_ns_.reset();
      }
      note("time from column {} \"{}\" in {}{}", *columns_.time + 1, base::one_line(column.text, 40),
           unit->name, unit->inspected ? ", by inspection" + unit->rates : "");
    }
    time_s_ = RowView{table_.time, 0.0, unit_s, request_.reverse};
    grid_options_.digit_s = std::pow(10.0, -table_.time_decimals) * unit_s;
    return {};
  }

  /// This time since 1970 and seconds after it; nullopt beyond the farthest epoch.
  static std::optional<std::int64_t> later(std::int64_t time_ns, double offset_s) {
    const bool is_near = std::abs(1e-9 * static_cast<double>(time_ns) + offset_s) < kFarthestEpoch_s &&
                         std::abs(offset_s) < kFarthestEpoch_s;
    return is_near ? std::optional{time_ns + std::llround(1e9 * offset_s)} : std::nullopt;
  }

  /// From the first row of the file to the first scan.
  void move_start() {
    if (start_ns_ && !time_s_.empty()) start_ns_ = later(*start_ns_, time_s_.front());
  }

  Result<void> add_run(std::size_t begin, std::size_t end) {
    const std::size_t count = end - begin;
    const RowView value = value_.part(begin, count);
    const auto run = std::make_shared<record::ScanColumns>(request_.scratch_folder);
    double rate_Hz = 0.0;
    bool each_row_counts = false;
    gaps_are_estimated_ = false;
    if (time_s_.empty()) {
      rate_Hz = *request_.rate_Hz;
      Grid grid;
      grid.index = counted(count, request_.scratch_folder);
      take_rows(grid, value, *run);
    } else {
      const RowView time = time_s_.part(begin, count);
      grid_options_.scratch_folder = request_.scratch_folder;
      auto grid = grid_of(time, grid_options_, [this, begin](std::size_t row) {
        return fmt::format("{}:{}", request_.path, line(begin + row));
      });
      if (!grid) return tl::unexpected(grid.error());
      tell(*grid, begin);
      if (!grid->rate_checked && !count_scans(*grid, begin, count)) {
        const auto missing = grid->index.back() + 1 - static_cast<daq::ScanIndex>(count);
        gaps_are_estimated_ = missing > 0;
        if (missing > 0) note("about {} scans are missing where the time column jumps", missing);
      }
      rate_Hz = grid->rate_Hz;
      each_row_counts =
          !grid->rate_checked && grid->index.back() + 1 == static_cast<daq::ScanIndex>(grid->index.size());
      if (grid->uniform) {
        take_rows(*grid, value, *run);
      } else {
        resample(rate_Hz, time, value, *run);
      }
    }
    const std::size_t scans = run->scan.size();
    if (static_cast<double>(scans) < (1.0 - kMostHoles) * static_cast<double>(count) || scans < 2) {
      return base::usage_error("{}: {} of {} values of column \"{}\" are missing: choose another column",
                               request_.path, count - scans, count,
                               base::one_line(dialect_.columns[columns_.value].text, 40));
    }
    // Where the times are too coarse and each row counts as a scan, rows have the only times.
    return add_tests(run, begin, rate_Hz, [&](daq::ScanIndex scan) -> std::optional<std::int64_t> {
      if (!start_ns_ || time_s_.empty()) return start_ns_;
      const double offset_s = each_row_counts ? time_s_[begin + static_cast<std::size_t>(scan)]
                                              : time_s_[begin] + static_cast<double>(scan) / rate_Hz;
      return later(*start_ns_, offset_s - time_s_.front());
    });
  }

  /// Runs of as many rows cannot be told from a counter that starts again.
  void tell_starts(const Continued& counter, std::size_t column) {
    if (counter.starts == 0) return;
    note(
        "column \"{}\" starts again after {:.0f}, {} time{}, as a counter of {:.0f} bits does: the rows go "
        "on there. If each start is that of a run, put each into a file of its own",
        base::one_line(dialect_.columns[column].text, 40), counter.end - 1.0, counter.starts,
        counter.starts == 1 ? "" : "s", std::log2(counter.end));
  }

  /// Indices of a column that counts the scans, which a coarse clock does not tell. \return false if there
  /// is none: then grid stays.
  bool count_scans(Grid& grid, std::size_t begin, std::size_t count) {
    const auto column = counter_column_of(dialect_, columns_.value);
    if (!column || column == columns_.time) return false;
    if (counter_.column.empty() && counter_was_read_) return false;
    if (counter_.column.empty()) {
      counter_was_read_ = true;
      auto table = read_table(source_, dialect_, columns_.value, column, request_.scratch_folder);
      if (!table || table->time.size() != row_count_) return false;
      counter_ = continued(std::move(table->time), table->first_time, true, request_.scratch_folder);
    }
    const RowView rows = RowView{counter_.column, 0.0, 1.0, request_.reverse}.part(begin, count);
    if (!is_count(rows)) return false;
    GridOptions options;
    options.rate_Hz = 1.0;
    options.scratch_folder = request_.scratch_folder;
    auto counted = grid_of(rows, options, [](std::size_t) { return std::string{}; });
    // A number of the row counts what is there; the clock may have seen more.
    if (!counted || std::as_const(counted->index).back() < std::as_const(grid.index).back()) return false;
    grid.index = std::move(counted->index);
    note("column \"{}\" counts the scans", base::one_line(dialect_.columns[*column].text, 40));
    tell_starts(counter_, *column);
    return true;
  }

  void tell(const Grid& grid, std::size_t begin) {
    if (!grid.rate_checked) {
      note("the time column is too coarse to check the rate of {:.6g} Hz", grid.rate_Hz);
      base::add(
          findings_,
          base::make_finding(
              base::FindingCode::kRateUnchecked,
              fmt::format("scan rate {:.6g} Hz is not checked: the time column is too coarse", grid.rate_Hz),
              {{"scan_rate", grid.rate_Hz, "Hz"}}));
      return;
    }
    note("{:.7g} scans a second by the time column, largest jitter {:.2g} % of the interval, in {} {}",
         grid.rate_Hz, 100.0 * grid.largest_jitter, row_word(), line(begin + grid.largest_row));
    if (!grid.uniform) note("scans interpolated at equal intervals of {:.6g} s", 1.0 / grid.rate_Hz);
    if (const auto doubled = std::count(grid.doubled.begin(), grid.doubled.end(), true); doubled > 0)
      note("{} rows with the time of the row before left out", doubled);
  }

  /// \param first_row  of the run. \param start_of  time of a scan of the run, ns since 1970; nullopt if
  /// unknown.
  Result<void> add_tests(const std::shared_ptr<const record::ScanColumns>& run, std::size_t first_row,
                         double rate_Hz,
                         const std::function<std::optional<std::int64_t>(daq::ScanIndex)>& start_of) {
    record::Record whole;
    record::RecordHeader& header = whole.header;
    header.title = std::filesystem::path{request_.path}.stem().string();
    header.board.driver = "import";
    header.board.device = std::filesystem::path{request_.path}.filename().string();
    set_board(header.board);
    header.board.scan_rate_requested_Hz = request_.rate_Hz.value_or(rate_Hz);
    header.board.scan_rate_granted_Hz = rate_Hz;
    header.load_cell = load_cell_;
    header.tester = request_.tester;
    header.sample = request_.sample;
    header.process = request_.process;
    const daq::Calibration calibration{header.board, load_cell_.value_or(daq::LoadCell{}),
                                       header.tester.tester().normal_load_N()};
    const base::LongColumn<double>& raw = run->raw;
    const auto coefficient = [&](std::size_t i) { return calibration.coefficient(raw[i]); };
    const double level = sliding_level(raw.size(), coefficient);
    if (several_runs_ && std::abs(level) < pipeline::SegmenterSettings{}.end_coefficient) {
      // The sign of an unloaded cell is that of its zero and its noise; another run tells that of the trace.
      note("the run of {} {} has hardly any load, {:.2g} as a coefficient: its sign is not checked",
           row_word(), line(first_row), level);
    } else if (level < 0.0) {
      return base::usage_error("{}: the force is negative while sliding, {:.4g} as a coefficient: {}",
                               request_.path, level,
                               request_.invert ? "leave out --invert" : "give --invert");
    }
    const base::LongColumn<daq::ScanIndex>& scan = run->scan;
    for (const auto& [begin, end] : tests_in(scan, coefficient, rate_Hz)) {
      ImportedTest test{whole, {run, begin, end - begin}};
      daq::ScanIndex next = scan[begin];
      test.record.header.start_realtime_ns = start_of(next);
      for (std::size_t i = begin; i < end; ++i) {
        if (scan[i] > next)
          test.record.gaps.push_back(
              {next, scan[i] - next, gaps_are_estimated_, daq::GapCause::kMissingScans});
        next = scan[i] + 1;
      }
      imported_.tests.push_back(std::move(test));
    }
    return {};
  }

  Result<Imported> finish() {
    std::int64_t number = 0;
    for (ImportedTest& test : imported_.tests) {
      record::Record& record = test.record;
      record.header.uuid = record::make_uuid();
      if (imported_.tests.size() > 1) record.header.test_number = ++number;
      record::ProcessFacts& process = record.header.process;
      process.source_size = table_.size;
      process.source_file = std::filesystem::path{request_.path}.filename().string();
      process.source_sha256 = table_.sha256;
      process.source_reading = imported_.report + notes_;
      record.end.emplace().results = record::absent_results("not analysed");
      record.end->cause = "end-of-input";
      record.end->results.findings = findings_;
    }
    imported_.report += notes_;
    return std::move(imported_);
  }

  const ImportRequest& request_;
  const Source& source_;
  Dialect dialect_;
  Columns columns_;
  TraceTable table_;
  bool counter_was_read_ = false;
  bool several_runs_ = false;
  Continued counter_;  ///< Of the scans, beside a coarse clock; else empty.
  std::size_t row_count_ = 0;
  RowView value_;   ///< In board.quantity.
  RowView time_s_;  ///< Empty without a column of times.
  GridOptions grid_options_;
  std::optional<std::int64_t> start_ns_;
  std::string unit_;
  RawQuantity quantity_ = RawQuantity::kForce_N;
  double scale_ = 1.0;
  std::optional<daq::LoadCell> load_cell_;
  bool gaps_are_estimated_ = false;  ///< In the run at hand, from a coarse clock.
  std::vector<base::Finding> findings_;
  std::string notes_;
  Imported imported_;
};

/// The first option that says what a table of stickslip export says itself; nullptr if there is none.
const char* needless_option(const ImportRequest& request) {
  const std::array stated{
      std::pair{"--unit", !request.unit.empty()},
      std::pair{"--time-column", !request.time_column.empty()},
      std::pair{"--time-unit", !request.time_unit.empty()},
      std::pair{"--rate", request.rate_Hz.has_value()},
      std::pair{"--invert", request.invert},
      std::pair{"--reverse", request.reverse},
      std::pair{"--resample", request.resample},
      std::pair{"--skip-doubled", request.skip_doubled},
      std::pair{"--sled-mass", request.tester.sled_mass_kg.has_value()},
      std::pair{"--speed", request.tester.pull_speed_m_per_s.has_value()},
      std::pair{"--stiffness", request.tester.stiffness_N_per_m.has_value()},
      std::pair{"--load-cell-frequency", request.tester.load_cell_frequency_Hz.has_value()},
      std::pair{"--anti-alias", request.tester.anti_alias_Hz.has_value()},
      std::pair{"--count-range", request.counts.has_value()},
      std::pair{"--load-cell-gain", request.load_cell.has_value()},
      std::pair{"--sample", !request.sample.name.empty()},
      std::pair{"--grade", !request.sample.grade.empty()},
      std::pair{"--operator", !request.sample.operator_name.empty()},
      std::pair{"--replicate", request.sample.replicate.has_value()},
      std::pair{"--encoding", request.dialect.encoding.has_value()},
      std::pair{"--separator", request.dialect.separator.has_value()},
      std::pair{"--decimal", request.dialect.decimal.has_value()},
      std::pair{"--skip", request.dialect.skip > 0}};
  const auto* const found =
      std::find_if(stated.begin(), stated.end(), [](const auto& option) { return option.second; });
  return found == stated.end() ? nullptr : found->first;
}

Result<Imported> import_own(const ImportRequest& request, const Source& source) {
  if (const char* const option = needless_option(request)) {
    return base::usage_error(
        "{}: is a table of stickslip export, which states all facts of its record: leave out {}, or give "
        "--column NAME to read it as one of another program",
        request.path, option);
  }
  auto test = read_own_table(source, request.scratch_folder);
  if (!test) return tl::unexpected(test.error());
  record::RecordHeader& header = test->record.header;
  record::Metadata& metadata = header.sample.metadata;
  for (const auto& [key, value] : request.sample.metadata) {
    if (const auto added = record::add_metadata(metadata, fmt::format("{}={}", key, value), "--set-meta");
        !added)
      return tl::unexpected(added.error());
  }
  if (!request.process.method.empty()) header.process.method = request.process.method;
  Imported imported;
  imported.is_own = true;
  imported.report = header.process.source_reading;
  imported.tests.push_back(std::move(*test));
  return imported;
}

}  // namespace

Result<Imported> import_trace(const ImportRequest& request) {
  auto source = Source::of(request.path);
  if (!source) return tl::unexpected(source.error());
  source->progress = request.progress;
  if (request.column.empty()) {
    // recognise() reports files that are not text.
    const auto is_own = is_own_table(*source);
    if (is_own && *is_own) return import_own(request, *source);
  }
  auto dialect = recognise(*source, request.dialect);
  if (!dialect) return tl::unexpected(dialect.error());
  if (request.column.empty()) return tl::unexpected(no_column_chosen(request, *source, *dialect));
  return Importer{request, *source, std::move(*dialect)}.import();
}

}  // namespace stickslip::traces
