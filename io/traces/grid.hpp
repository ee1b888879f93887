/// \file
/// The scan index of each row, from the times beside the values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/traces/row_view.hpp"

#include "core/base/long_column.hpp"
#include "core/base/result.hpp"

namespace stickslip::traces {

/// Displacement of a row from its place in equal intervals that counts as jitter, of an interval.
inline constexpr double kLargestJitter = 0.1;
/// Largest relative difference of the stated rate from that of the times.
inline constexpr double kRateTolerance = 1e-3;

struct GridOptions {
  std::optional<double> rate_Hz;  ///< Stated by the user; compared with the times.
  double digit_s = 0.0;           ///< One printed digit of the times: they may be rounded or cut to it.
  bool resample = false;          ///< Unequal intervals are no error.
  bool skip_doubled = false;      ///< A row with the time of the row before it is left out.
  std::string time_unit;          ///< In which the times were read, for messages.
  std::filesystem::path scratch_folder{};  ///< Of Grid::index, as of base::LongColumn.
};

/// Rows of one run on equal intervals.
struct Grid {
  double rate_Hz = 0.0;
  base::LongColumn<std::int64_t> index;  ///< Of each row, from 0, rising; a jump is a gap.
  std::vector<bool> doubled;             ///< Rows to leave out; empty: none.
  double largest_jitter = 0.0;  ///< Largest displacement, of an interval, beyond the rounding of the digits.
  std::size_t largest_row = 0;
  bool rate_checked = true;  ///< False where the times are too coarse to check the stated rate.
  bool uniform = true;       ///< False only with resample.
};

/// Where a row's number stands for the user: "trace.csv:17".
using Place = std::function<std::string(std::size_t row)>;

/// 0, 1, … of rows whose times are not read. \param scratch_folder  as GridOptions.
[[nodiscard]] base::LongColumn<std::int64_t> counted(std::size_t count,
                                                     const std::filesystem::path& scratch_folder);

/// First rows of the runs of a column in which a clock starts again. One element, 0, for one run.
[[nodiscard]] std::vector<std::size_t> runs_in(const RowView& time_s);

/// Whether most rows rise or fall by the same whole number, as in a column that counts scans.
[[nodiscard]] bool is_count(const RowView& column);

struct Continued {
  base::LongColumn<double> column;
  double end = 0.0;        ///< Where it started again: 2^8, 2^16, 2^24 or 2^32; 0: nowhere.
  std::size_t starts = 0;  ///< How often it did.
};

/// The column, continued where its whole numbers start again at 2^16, 2^24 or 2^32, as counters do; else as
/// it was. \param first  what was subtracted from the column. \param counts  2^8 is looked for too.
[[nodiscard]] Continued continued(base::LongColumn<double> column, double first, bool counts,
                                  const std::filesystem::path& scratch_folder);

/// \param time_s  of the rows of one run, finite, at least two.
/// Errors, kUsage, each with its remedy: times that do not advance, run backwards, are doubled, are too
/// coarse, are unequal by more than kLargestJitter, or have another rate than the stated one.
[[nodiscard]] base::Result<Grid> grid_of(const RowView& time_s, const GridOptions& options,
                                         const Place& place);

}  // namespace stickslip::traces
