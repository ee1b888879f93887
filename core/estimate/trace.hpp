/// \file
/// The scans of one test as the estimators see them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/long_column.hpp"
#include "core/model/belt_course.hpp"

namespace stickslip::estimate {

/// What K and S change by together while a test lasts, in a line.
struct Drift {
  double rate_per_s = 0.0;
  double zero_at_s = 0.0;  ///< Where it counts as none.

  [[nodiscard]] double at(double time_s) const noexcept { return rate_per_s * (time_s - zero_at_s); }
};

/// Columns of equal length, in the order of time.
struct Trace {
  base::LongColumn<double> time_s;        ///< (scan index − first index of the record) / granted rate.
  base::LongColumn<double> value;         ///< Coefficient; a spike is replaced by the median around it.
  base::LongColumn<std::uint8_t> usable;  ///< 0 for a spike or a saturated scan: left out of fits.

  /// Taken off for the fits, and added again to what they find. Exact for the model: with c − βt for c, K and
  /// S become constant, and the stick rate r is less by β.
  Drift drift;

  /// Over the time of the trace.
  model::BeltCourse belt;

  /// Scans before which the trace is broken: what the sled did between them and the scan before is not known.
  /// Rising. Gaps of a few scans that were counted break nothing.
  std::vector<std::size_t> breaks{};
  double lost_s = 0.0;  ///< Time without scans, over all gaps.

  /// The coefficient without the drift.
  [[nodiscard]] double level(std::size_t scan) const noexcept { return value[scan] - drift.at(time_s[scan]); }
  [[nodiscard]] std::size_t size() const noexcept { return value.size(); }
};

/// There is a break between two positions.
[[nodiscard]] inline bool is_broken(const Trace& trace, double from, double to) noexcept {
  const auto at = [](std::size_t scan) { return static_cast<double>(scan) - 0.5; };
  const auto first = std::upper_bound(trace.breaks.begin(), trace.breaks.end(), from,
                                      [&](double position, std::size_t scan) { return position < at(scan); });
  return first != trace.breaks.end() && at(*first) < to;
}

/// Position between scans → time of the trace.
[[nodiscard]] inline double time_at(const Trace& trace, double position) noexcept {
  const auto before =
      static_cast<std::size_t>(std::clamp(position, 0.0, static_cast<double>(trace.size() - 1)));
  const std::size_t after = std::min(before + 1, trace.size() - 1);
  return trace.time_s[before] +
         (position - static_cast<double>(before)) * (trace.time_s[after] - trace.time_s[before]);
}

/// First scan at or after a time; the size of the trace if there is none. It is looked for from \p near on,
/// in steps that double [Bentley and Yao 1976]: scans far away may have to be fetched from a file.
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
