#include "io/traces/grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/signal/statistics.hpp"

namespace stickslip::traces {

using Index = base::LongColumn<std::int64_t>;

namespace {

/// A step that goes back by more than this part of the run's length is a clock that starts again.
constexpr double kRestartShare = 0.5;
/// Steps between these parts of the median one are single intervals.
constexpr double kShortestStep = 0.5;
constexpr double kLongestStep = 1.5;
/// Times with fewer digits than this in an interval cannot check a rate.
constexpr double kCoarsest = 0.5;

/// Times of the rows that count, without copies of a long column.
class Times {
 public:
  explicit Times(const RowView& all) : all_(all) {}

  /// Leaves out each row with the time of the row before it; true for such a row.
  std::vector<bool> skip_doubled(const std::filesystem::path& scratch_folder) {
    rows_ = base::LongColumn<std::size_t>{scratch_folder};
    std::vector<bool> doubled(all_.size(), false);
    for (std::size_t i = 0; i < all_.size(); ++i) {
      doubled[i] = i > 0 && all_[i] == all_[i - 1];
      if (!doubled[i]) rows_.push_back(i);
    }
    return doubled;
  }

  [[nodiscard]] std::size_t size() const noexcept { return rows_.empty() ? all_.size() : rows_.size(); }
  /// In the column, of one of size().
  [[nodiscard]] std::size_t row(std::size_t i) const { return rows_.empty() ? i : rows_[i]; }
  [[nodiscard]] double operator[](std::size_t i) const { return all_[row(i)]; }

  /// Steps from one time to the next.
  [[nodiscard]] std::size_t steps() const noexcept { return size() - 1; }
  [[nodiscard]] double step(std::size_t i) const { return (*this)[i + 1] - (*this)[i]; }
  [[nodiscard]] double median_step() const {
    return signal::median_of(steps(), [this](std::size_t i) { return step(i); });
  }

 private:
  RowView all_;
  base::LongColumn<std::size_t> rows_;  ///< Empty: all.
};

/// What one walk over the steps shows.
struct Steps {
  double shortest = std::numeric_limits<double>::infinity();
  double longest = -std::numeric_limits<double>::infinity();
  std::size_t backwards = 0;
  std::size_t first_backwards = 0;
  std::size_t standing = 0;
  std::size_t first_standing = 0;
};

Steps steps_of(const Times& time) {
  Steps steps;
  for (std::size_t i = 0; i < time.steps(); ++i) {
    const double step = time.step(i);
    if (step < 0.0 && steps.backwards++ == 0) steps.first_backwards = i;
    if (step == 0.0 && steps.standing++ == 0) steps.first_standing = i;
    steps.shortest = std::min(steps.shortest, step);
    steps.longest = std::max(steps.longest, step);
  }
  return steps;
}

struct Interval {
  double mean = 0.0;     ///< Of the steps that are single intervals, those rounded to a coarse digit too.
  bool unequal = false;  ///< They differ by a digit or more.
};

Interval interval_of(const Times& time, const Steps& steps, double digit_s) {
  // All are single intervals, wherever the median lies between them.
  if (steps.shortest >= kShortestStep * steps.longest - digit_s &&
      steps.longest <= kLongestStep * steps.shortest + digit_s) {
    return {(time[time.size() - 1] - time[0]) / static_cast<double>(time.steps()),
            steps.longest - steps.shortest > 0.5 * digit_s};
  }
  const double middle = time.median_step();
  double sum = 0.0;
  std::size_t count = 0;
  double shortest = middle;
  double longest = middle;
  for (std::size_t i = 0; i < time.steps(); ++i) {
    const double step = time.step(i);
    if (step < kShortestStep * middle - digit_s || step > kLongestStep * middle + digit_s) continue;
    sum += step;
    ++count;
    shortest = std::min(shortest, step);
    longest = std::max(longest, step);
  }
  return {count == 0 ? middle : sum / static_cast<double>(count), longest - shortest > 0.5 * digit_s};
}

struct Line {
  double origin = 0.0;
  double slope = 0.0;
};

/// Least squares of the times on the indices.
Line line_through(const Index& index, const Times& time) {
  const auto n = static_cast<double>(time.size());
  double mean_x = 0.0;
  double mean_y = 0.0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    mean_x += static_cast<double>(index[i]);
    mean_y += time[i];
  }
  mean_x /= n;
  mean_y /= n;
  double xx = 0.0;
  double xy = 0.0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    const double x = static_cast<double>(index[i]) - mean_x;
    xx += x * x;
    xy += x * (time[i] - mean_y);
  }
  const double slope = xy / xx;
  return {mean_y - slope * mean_x, slope};
}

/// Equal intervals through the times.
struct Fit {
  Line line;
  double jitter =
      0.0;  ///< Largest displacement of a time, of an interval, beyond the rounding of the digits.
  std::size_t largest = 0;  ///< Of which time.
};

Fit fit_of(const Index& index, const Times& time, double digit_s) {
  Fit fit;
  fit.line = line_through(index, time);
  double largest = 0.0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    const double on_line = fit.line.origin + fit.line.slope * static_cast<double>(index[i]);
    const double off = std::abs(time[i] - on_line) - 0.5 * digit_s;
    if (off > largest) {
      largest = off;
      fit.largest = i;
    }
  }
  fit.jitter = largest / fit.line.slope;
  return fit;
}

/// Cumulative, so that a slow drift of the clock moves no row.
Index indices(const Times& time, double interval, const std::filesystem::path& scratch_folder) {
  Index index{scratch_folder};
  std::int64_t scan = 0;
  index.push_back(scan);
  double carried = 0.0;  // What rounding left of the steps so far, in intervals.
  for (std::size_t i = 0; i < time.steps(); ++i) {
    const double wanted = time.step(i) / interval + carried;
    const double whole = std::max(1.0, std::round(wanted));
    carried = wanted - whole;
    index.push_back(scan += static_cast<std::int64_t>(whole));
  }
  return index;
}

base::Result<void> check_rate(const GridOptions& options, double rate_Hz, const std::string& at) {
  if (!options.rate_Hz || std::abs(rate_Hz / *options.rate_Hz - 1.0) <= kRateTolerance) return {};
  const double ratio = *options.rate_Hz / rate_Hz;
  for (const auto& [factor, unit] : {std::pair{1e3, "ms"}, std::pair{1e6, "us"}}) {
    if (options.time_unit == "s" && std::abs(ratio / factor - 1.0) < 0.05) {
      return base::usage_error(
          "{}: the time column runs at {:.6g} Hz when read in s, --rate says {:.6g} Hz: it is in {}; "
          "give --time-unit {}",
          at, rate_Hz, *options.rate_Hz, unit, unit);
    }
  }
  return base::usage_error(
      "{}: the time column runs at {:.6g} Hz, --rate says {:.6g} Hz: leave out --rate to go by the column, "
      "or give "
      "--time-column none to go by the rate",
      at, rate_Hz, *options.rate_Hz);
}

/// Rows in which a coarse clock shows another time than in the row before.
class Ticks {
 public:
  Ticks(const Times& time, double rate_Hz, const std::filesystem::path& scratch_folder)
      : time_(time), rate_Hz_(rate_Hz), row_(scratch_folder) {
    for (std::size_t i = 1; i < time.size(); ++i) {
      if (time[i] != time[i - 1]) row_.push_back(i);
    }
    resolution_s_ = signal::median_of(row_.size(), [this](std::size_t k) { return step(k); });
  }

  /// One index a row; a tick that is too long for the clock and the rate stands for missing rows.
  [[nodiscard]] Index indices(const std::filesystem::path& scratch_folder) const {
    // What the clock makes up again is no gap.
    if (lost() <= resolution_s_ * rate_Hz_ + 1.0) return counted(time_.size(), scratch_folder);
    Index index{scratch_folder};
    std::int64_t missing = 0;
    std::size_t k = 0;
    for (std::size_t i = 0; i < time_.size(); ++i) {
      if (k < row_.size() && row_[k] == i) missing += missing_at(k++);
      index.push_back(static_cast<std::int64_t>(i) + missing);
    }
    return index;
  }

  /// Refuses a rate that is none of the clock's, with its resolution at both ends.
  [[nodiscard]] base::Result<void> check(const std::string& at) const {
    constexpr double kMostScans = 1e12;
    if (const double span_s = time_[time_.size() - 1] - time_[0]; !(span_s * rate_Hz_ < kMostScans))
      return base::usage_error(
          "{}: the time column spans {:.6g} s: correct it, or give --time-column none to go by the rate", at,
          span_s);
    if (std::abs(lost()) <= resolution_s_ * rate_Hz_ + 1.0) return {};
    double rows = 0.0;
    double span_s = 0.0;
    for (std::size_t k = 1; k < row_.size(); ++k) {
      if (is_gap(k) || is_gap(k - 1)) continue;
      rows += static_cast<double>(row_[k] - row_[k - 1]);
      span_s += step(k);
    }
    // Missing rows only lower their number: all of them tell whether the rate is too low.
    const auto all = static_cast<double>(row_.back() - row_.front());
    const double whole_s = time_[row_.back()] - time_[row_.front()];
    const bool is_slower = all > (1.0 + kRateTolerance) * rate_Hz_ * (whole_s + resolution_s_);
    const bool is_faster = rows < (1.0 - kRateTolerance) * rate_Hz_ * (span_s - resolution_s_);
    if (!is_slower && !is_faster) return {};
    return base::usage_error(
        "{}: the time column shows {} rows in {:.6g} s, --rate says {:.6g} Hz: give --time-column none to go "
        "by the rate, or --rate \"{:.6g} Hz\" to go by the column if its unit is right",
        at, is_slower ? all : rows, is_slower ? whole_s : span_s, rate_Hz_,
        is_slower ? all / whole_s : rows / span_s);
  }

 private:
  [[nodiscard]] double step(std::size_t k) const { return time_[row_[k]] - time_[row_[k] - 1]; }
  /// Rows that the whole clock shows and that are not there; to its resolution.
  [[nodiscard]] double lost() const {
    return (time_[time_.size() - 1] - time_[0]) * rate_Hz_ - static_cast<double>(time_.steps());
  }
  /// A step that the rows with one time before and behind it do not account for.
  [[nodiscard]] bool is_gap(std::size_t k) const {
    const std::size_t next = k + 1 < row_.size() ? row_[k + 1] : time_.size();
    const std::size_t rows = std::max(row_[k] - (k > 0 ? row_[k - 1] : 0), next - row_[k]);
    return step(k) > kLongestStep * resolution_s_ + 1.0 / rate_Hz_ &&
           step(k) * rate_Hz_ > kLongestStep * static_cast<double>(rows) + 1.0;
  }
  [[nodiscard]] std::int64_t missing_at(std::size_t k) const {
    if (!is_gap(k)) return 0;
    // The ticks on both sides tell the time to an interval, the step alone to the clock's resolution.
    const bool between = k > 0 && k + 1 < row_.size() && !is_gap(k - 1) && !is_gap(k + 1);
    const std::size_t first = between ? row_[k - 1] : row_[k] - 1;
    const std::size_t last = between ? row_[k + 1] : row_[k];
    const auto scans = std::llround((time_[last] - time_[first]) * rate_Hz_);
    return std::max<std::int64_t>(0, scans - static_cast<std::int64_t>(last - first));
  }

  const Times& time_;
  double rate_Hz_;
  base::LongColumn<std::size_t> row_;
  double resolution_s_ = 0.0;
};

}  // namespace

Index counted(std::size_t count, const std::filesystem::path& scratch_folder) {
  Index index{scratch_folder};
  for (std::size_t i = 0; i < count; ++i) index.push_back(static_cast<std::int64_t>(i));
  return index;
}

std::vector<std::size_t> runs_in(const RowView& time_s) {
  std::vector<std::size_t> runs{0};
  double highest = time_s.empty() ? 0.0 : time_s.front();
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    const double length = highest - time_s[runs.back()];
    if (i > runs.back() + 1 && time_s[i] < time_s[i - 1] && highest - time_s[i] > kRestartShare * length) {
      runs.push_back(i);
      highest = time_s[i];
    }
    highest = std::max(highest, time_s[i]);
  }
  // A clock that runs backwards starts again at every row; that is no run.
  if (runs.size() > 1 && runs.size() > time_s.size() / 4) return {0};
  return runs;
}

bool is_count(const RowView& column) {
  if (column.size() < 2) return false;
  const Times count{column};
  const double middle = count.median_step();
  std::size_t same = 0;
  for (std::size_t i = 0; i < count.steps(); ++i) same += count.step(i) == middle ? 1U : 0U;
  return std::abs(middle) == 1.0 && 2 * same > count.steps();
}

Continued continued(base::LongColumn<double> column, double first, bool counts,
                    const std::filesystem::path& scratch_folder) {
  if (column.size() < 2) return {std::move(column)};
  const Times rows{RowView{column, -first, 1.0, false}};
  double highest = rows[0];
  bool falls = false;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    highest = std::max(highest, rows[i]);
    falls = falls || rows[i] < rows[i - 1];
  }
  if (!falls) return {std::move(column)};
  const double step = rows.median_step();
  for (const double wrap : {0x1p8, 0x1p16, 0x1p24, 0x1p32}) {
    // It has come to within a step of the end, or 0.1 % where rows are missing there.
    if (highest >= wrap || highest < wrap - std::max(step, 1e-3 * wrap) || !(step > 0.0)) continue;
    if (wrap == 0x1p8 && !counts) break;
    Continued whole{base::LongColumn<double>{scratch_folder}, wrap, 0};
    double before = rows[0];
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double now = rows[i];
      whole.starts += now < before && now + wrap - before < 0.25 * wrap;
      before = now;
      whole.column.push_back(now - first + static_cast<double>(whole.starts) * wrap);
    }
    if (whole.starts > 0) return whole;
    break;
  }
  return {std::move(column)};
}

base::Result<Grid> grid_of(const RowView& all_times, const GridOptions& options, const Place& place) {
  Grid grid;
  Times time{all_times};
  if (options.skip_doubled) grid.doubled = time.skip_doubled(options.scratch_folder);
  bool advances = false;
  for (std::size_t i = 1; i < all_times.size() && !advances; ++i) advances = all_times[i] != all_times[0];
  if (!advances || time.size() < 2) {
    return base::usage_error(
        "{}: the time column does not advance: give --time-column none and --rate HZ, or the name of "
        "another column of times",
        place(0));
  }
  const Steps steps = steps_of(time);
  const std::size_t standing = steps.standing;
  if (2 * steps.backwards > time.steps()) {
    return base::usage_error(
        "{}: time runs backwards: give --reverse to read the rows from the last to the first", place(0));
  }
  if (steps.backwards > 0) {
    return base::usage_error(
        "{}: time goes back by {:.6g} s in this row: the clock was set while the file was written. If the "
        "scans are evenly "
        "spaced, give --time-column none and --rate HZ",
        place(time.row(steps.first_backwards + 1)), -time.step(steps.first_backwards));
  }
  const auto [interval, unequal] = interval_of(time, steps, options.digit_s);
  const bool coarse = 4 * standing > time.steps() || !(interval > 0.0);
  if (coarse) {
    if (!options.rate_Hz) {
      return base::usage_error(
          "{}: the time column has a step of {:.6g} s, too coarse to tell the scan rate: give --rate HZ",
          place(time.row(standing > 0 ? 1 : 0)), options.digit_s);
    }
    grid.rate_Hz = *options.rate_Hz;
    grid.rate_checked = false;
    const Ticks ticks{time, grid.rate_Hz, options.scratch_folder};
    if (const auto rate = ticks.check(place(0)); !rate) return tl::unexpected(rate.error());
    grid.index = ticks.indices(options.scratch_folder);
    grid.doubled.clear();
    return grid;
  }
  if (standing > 0 && options.digit_s < kCoarsest * interval) {
    return base::usage_error(
        "{}: this row has the time of the row before it, as have {} in all: give --skip-doubled to leave "
        "such rows out",
        place(time.row(steps.first_standing + 1)), standing);
  }

  const auto index_for = [&](double step_s) { return indices(time, step_s, options.scratch_folder); };
  Index index = index_for(interval);
  // A step of two coarse digits is one long interval or a missing row; only without gaps is it surely the
  // first.
  if (unequal && options.digit_s >= kCoarsest * interval &&
      index.back() + 1 != static_cast<std::int64_t>(time.size())) {
    if (!options.rate_Hz) {
      return base::usage_error(
          "{}: the time column has a step of {:.6g} s, too coarse to tell missing rows from the scan rate: "
          "give "
          "--rate HZ",
          place(0), options.digit_s);
    }
    index = index_for(1.0 / *options.rate_Hz);
    grid.rate_checked = false;
  }
  Fit fit = fit_of(index, time, options.digit_s);
  if (unequal && options.digit_s >= kCoarsest * interval && fit.jitter > kLargestJitter) {
    // Long intervals do not fit: the long steps are missing rows.
    Index with_gaps = index_for(time.median_step());
    if (const Fit other = fit_of(with_gaps, time, options.digit_s); other.jitter <= kLargestJitter) {
      index = std::move(with_gaps);
      fit = other;
    }
  }
  grid.rate_Hz = 1.0 / fit.line.slope;
  grid.largest_row = time.row(fit.largest);
  grid.largest_jitter = fit.jitter;
  if (const auto rate = check_rate(options, grid.rate_Hz, place(0)); !rate)
    return tl::unexpected(rate.error());
  if (grid.largest_jitter > kLargestJitter) {
    if (!options.resample) {
      return base::usage_error(
          "{}: this row is displaced by {:.0f} % of the scan interval ({:.6g} s at {:.6g} Hz), more than the "
          "{:.0f} % of jitter: "
          "give --resample to interpolate the scans at equal intervals",
          place(grid.largest_row), 100.0 * grid.largest_jitter, fit.line.slope, grid.rate_Hz,
          100.0 * kLargestJitter);
    }
    grid.uniform = false;
  }
  if (grid.doubled.empty()) {
    grid.index = std::move(index);
  } else {
    grid.index = Index{options.scratch_folder};
    std::size_t kept = 0;  // A row that is left out has the index of the row before it.
    for (const bool doubled : grid.doubled) {
      if (!doubled) ++kept;
      grid.index.push_back(std::as_const(index)[kept - 1]);
    }
  }
  return grid;
}

}  // namespace stickslip::traces
