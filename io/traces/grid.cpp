#include "io/traces/grid.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace stickslip::traces {
namespace {

/// A step that goes back by more than this part of the run's length is a clock that starts again.
constexpr double kRestartShare = 0.5;
/// Steps between these parts of the median one are single intervals.
constexpr double kShortestStep = 0.5;
constexpr double kLongestStep = 1.5;
/// Times with fewer digits than this in an interval cannot check a rate.
constexpr double kCoarsest = 0.5;

std::vector<double> steps_of(const std::vector<double>& time) {
  std::vector<double> steps(time.size() - 1);
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = time[i + 1] - time[i];
  return steps;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Interval {
  double mean = 0.0;     ///< Of the steps that are single intervals, those rounded to a coarse digit too.
  bool unequal = false;  ///< They differ by a digit or more.
};

Interval interval_of(const std::vector<double>& steps, double digit_s) {
  const double middle = median(steps);
  double sum = 0.0;
  std::size_t count = 0;
  double shortest = middle;
  double longest = middle;
  for (const double step : steps) {
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
Line line_through(const std::vector<std::int64_t>& index, const std::vector<double>& time) {
  const auto n = static_cast<double>(time.size());
  const double mean_x = std::accumulate(index.begin(), index.end(), 0.0) / n;
  const double mean_y = std::accumulate(time.begin(), time.end(), 0.0) / n;
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

Fit fit_of(const std::vector<std::int64_t>& index, const std::vector<double>& time, double digit_s) {
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
std::vector<std::int64_t> indices(const std::vector<double>& steps, double interval) {
  std::vector<std::int64_t> index{0};
  index.reserve(steps.size() + 1);
  double carried = 0.0;  // What rounding left of the steps so far, in intervals.
  for (const double step : steps) {
    const double wanted = step / interval + carried;
    const double whole = std::max(1.0, std::round(wanted));
    carried = wanted - whole;
    index.push_back(index.back() + static_cast<std::int64_t>(whole));
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

}  // namespace

std::vector<std::size_t> runs_in(const std::vector<double>& time_s) {
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

base::Result<Grid> grid_of(const std::vector<double>& all_times, const GridOptions& options,
                           const Place& place) {
  Grid grid;
  std::vector<double> time = all_times;
  std::vector<std::size_t> row(time.size());  // Of what is left in `time`.
  std::iota(row.begin(), row.end(), std::size_t{0});
  if (options.skip_doubled) {
    grid.doubled.assign(time.size(), false);
    for (std::size_t i = 1; i < time.size(); ++i) grid.doubled[i] = all_times[i] == all_times[i - 1];
    std::erase_if(row, [&grid](std::size_t i) { return grid.doubled[i]; });
    time.clear();
    for (const std::size_t i : row) time.push_back(all_times[i]);
  }
  const auto [low, high] = std::minmax_element(all_times.begin(), all_times.end());
  if (*low == *high || time.size() < 2) {
    return base::usage_error(
        "{}: the time column does not advance: give --time-column none and --rate HZ, or the name of "
        "another column of times",
        place(0));
  }
  const std::vector<double> steps = steps_of(time);
  const auto backwards = static_cast<std::size_t>(
      std::count_if(steps.begin(), steps.end(), [](double step) { return step < 0.0; }));
  if (2 * backwards > steps.size()) {
    return base::usage_error(
        "{}: time runs backwards: give --reverse to read the rows from the last to the first", place(0));
  }
  if (backwards > 0) {
    const auto at = std::find_if(steps.begin(), steps.end(), [](double step) { return step < 0.0; });
    const auto i = static_cast<std::size_t>(at - steps.begin());
    return base::usage_error(
        "{}: time goes back by {:.6g} s in this row: the clock was set while the file was written. If the "
        "scans are evenly "
        "spaced, give --time-column none and --rate HZ",
        place(row[i + 1]), -*at);
  }
  const auto standing = static_cast<std::size_t>(std::count(steps.begin(), steps.end(), 0.0));
  const auto [interval, unequal] = interval_of(steps, options.digit_s);
  const bool coarse = 4 * standing > steps.size() || !(interval > 0.0);
  if (coarse) {
    if (!options.rate_Hz) {
      return base::usage_error(
          "{}: the time column has a step of {:.6g} s, too coarse to tell the scan rate: give --rate HZ",
          place(row[standing > 0 ? 1 : 0]), options.digit_s);
    }
    grid.rate_Hz = *options.rate_Hz;
    grid.rate_checked = false;
    grid.index.resize(all_times.size());
    std::iota(grid.index.begin(), grid.index.end(), std::int64_t{0});
    grid.doubled.clear();
    return grid;
  }
  if (standing > 0 && options.digit_s < kCoarsest * interval) {
    const auto i = static_cast<std::size_t>(std::find(steps.begin(), steps.end(), 0.0) - steps.begin());
    return base::usage_error(
        "{}: this row has the time of the row before it, as have {} in all: give --skip-doubled to leave "
        "such rows out",
        place(row[i + 1]), standing);
  }

  std::vector<std::int64_t> index = indices(steps, interval);
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
    index = indices(steps, 1.0 / *options.rate_Hz);
    grid.rate_checked = false;
  }
  Fit fit = fit_of(index, time, options.digit_s);
  if (unequal && options.digit_s >= kCoarsest * interval && fit.jitter > kLargestJitter) {
    // Long intervals do not fit: the long steps are missing rows.
    std::vector<std::int64_t> with_gaps = indices(steps, median(steps));
    if (const Fit other = fit_of(with_gaps, time, options.digit_s); other.jitter <= kLargestJitter) {
      index = std::move(with_gaps);
      fit = other;
    }
  }
  grid.rate_Hz = 1.0 / fit.line.slope;
  grid.largest_row = row[fit.largest];
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
  grid.index.assign(all_times.size(), 0);
  for (std::size_t i = 0; i < row.size(); ++i) grid.index[row[i]] = index[i];
  return grid;
}

}  // namespace stickslip::traces
