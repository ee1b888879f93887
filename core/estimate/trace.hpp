/// \file
/// Input of the estimators: the scans of one test, with drift, belt speed and breaks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/long_column.hpp"
#include "core/model/belt_motion.hpp"

namespace stickslip::estimate {

/// Linear drift common to K and S during a test.
struct Drift {
  double rate_per_s = 0.0;
  double zero_at_s = 0.0;  ///< Time at which the drift is zero.

  [[nodiscard]] double at(double time_s) const noexcept { return rate_per_s * (time_s - zero_at_s); }
};

/// Scans of one test: columns of equal length, in the order of time.
struct Trace {
  base::LongColumn<double> time_s;  ///< (scan index − first index of the record) / granted rate.
  /// Coefficient. A spike is replaced by what its neighbours have there, unless the analysis keeps spikes.
  base::LongColumn<double> value;
  /// 0 for a spike or a scan that is saturated, clipped or frozen; fits leave it out.
  base::LongColumn<std::uint8_t> usable;

  /// Drift. Fits subtract it from the values, so that their S and K lack it; who reports S and K adds it.
  /// Exact for the model: with c − βt in place of c, K and S are constant and the stick rate is r − β.
  Drift drift;

  /// Belt speed relative to its largest, on the axis of time_s. Constant, 1 throughout, unless a change is
  /// known: measured between the first and the last slip, planned with a start that was found, or holds at a
  /// known pull speed. Constant if no slip was found.
  model::BeltMotion belt;

  /// Positions of the first scans after breaks, rising: the motion between such a scan and the one before it
  /// is unknown. A counted gap shorter than half an oscillation is no break, unless the cycle that holds it
  /// is too long. Empty if no slip was found.
  std::vector<std::size_t> breaks{};
  double lost_s = 0.0;  ///< Time without scans, over all gaps; 0 if no slip was found.

  /// The coefficient without the drift.
  [[nodiscard]] double level(std::size_t scan) const { return value[scan] - drift.at(time_s[scan]); }
  [[nodiscard]] std::size_t size() const noexcept { return value.size(); }
  /// The same scans, to be read in another thread: base::LongColumn::view().
  [[nodiscard]] Trace view() const {
    return {time_s.view(), value.view(), usable.view(), drift, belt, breaks, lost_s};
  }
};

/// Largest coefficient of all scans, drift included; −∞ if there are none. Reads each scan once, in order
/// (std::max_element goes back to the largest, which is slow from a file).
[[nodiscard]] inline double largest_value(const Trace& trace) {
  double largest = -std::numeric_limits<double>::infinity();
  for (const double value : trace.value) largest = std::max(largest, value);
  return largest;
}

/// A usable scan without the drift.
struct TraceScan {
  double time_s;
  double level;
};

/// Appends the usable scans of [first, end), without the drift, to `scans`. Fits then read them many times
/// from memory, and a column in a file only once.
inline void append_usable(const Trace& trace, std::size_t first, std::size_t end,
                          std::vector<TraceScan>& scans) {
  for (std::size_t k = first; k < end; ++k) {
    const double time_s = trace.time_s[k];
    if (trace.usable[k] != 0) scans.push_back({time_s, trace.value[k] - trace.drift.at(time_s)});
  }
}

/// Whether a break lies between two positions, in scans: at half a scan before its entry in Trace::breaks.
[[nodiscard]] inline bool is_broken(const Trace& trace, double from, double to) noexcept {
  const auto at = [](std::size_t scan) { return static_cast<double>(scan) - 0.5; };
  const auto first = std::upper_bound(trace.breaks.begin(), trace.breaks.end(), from,
                                      [&](double position, std::size_t scan) { return position < at(scan); });
  return first != trace.breaks.end() && at(*first) < to;
}

/// Time of a fractional scan position, by linear interpolation; extrapolated before the first scan, that of
/// the last scan for positions after it. The trace must not be empty.
[[nodiscard]] inline double time_at(const Trace& trace, double position) noexcept {
  const auto before =
      static_cast<std::size_t>(std::clamp(position, 0.0, static_cast<double>(trace.size() - 1)));
  const std::size_t after = std::min(before + 1, trace.size() - 1);
  return trace.time_s[before] +
         (position - static_cast<double>(before)) * (trace.time_s[after] - trace.time_s[before]);
}

/// First scan at or after a time; the size of the trace if there is none. The search starts at \p near and
/// doubles its steps [Bentley and Yao 1976], since scans far away may have to be read from a file.
[[nodiscard]] inline std::size_t scan_at_or_after(const Trace& trace, double time_s, std::size_t near) {
  const std::size_t size = trace.size();
  std::size_t first = std::min(near, size);
  std::size_t end = first;
  for (std::size_t step = 1; first > 0 && trace.time_s[first - 1] >= time_s; step *= 2) {
    end = first - 1;
    first -= std::min(step, first);
  }
  for (std::size_t step = 1; end < size && trace.time_s[end] < time_s; step *= 2) {
    first = end + 1;
    end += std::min(step, size - end);
  }
  const auto at = [&](std::size_t scan) { return trace.time_s.begin() + static_cast<std::ptrdiff_t>(scan); };
  return static_cast<std::size_t>(std::lower_bound(at(first), at(end), time_s) - trace.time_s.begin());
}

}  // namespace stickslip::estimate
