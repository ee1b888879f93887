/// \file
/// Holds of a slide-hold-slide test: the belt stands still while the sled rests, and pulls on. The contact
/// ages meanwhile [Dieterich 1972]. The trace tells their times: the force stands still between two slips.
#pragma once

#include <optional>
#include <vector>

#include "core/analysis/results.hpp"
#include "core/base/finding.hpp"
#include "core/base/long_column.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/estimate/trace.hpp"
#include "core/model/pull_speed.hpp"

namespace stickslip::analysis {

/// On the trace's time axis.
struct Hold {
  double stop_s = 0.0;
  double go_s = 0.0;  ///< > stop_s
};

/// Holds between slips: the force takes at least three times as long from a trough to the next peak as it
/// needs at the rate of the other rises, and stands still in between, but for creep. The moments of stop and
/// go are where the level of the hold meets the two rises. A sled that slid as smoothly looks the same.
/// \param slips  in the order of time. \param sigma  noise of a scan. \return in the order of time.
[[nodiscard]] std::vector<Hold> find_holds(const estimate::Trace& trace,
                                           const base::LongColumn<detect::Fall>& slips, double sigma);

/// A belt of one speed that stands still in the holds. \param begin_s  of the course on the trace's time
/// axis. \param holds  not empty.
[[nodiscard]] std::optional<model::PullSpeed> course_with_holds(double pull_speed_m_per_s, double begin_s,
                                                                const std::vector<Hold>& holds);

/// Code kHolds. \param holds  not empty. \param left_out  the slips after them are not in S and S − K.
[[nodiscard]] base::Finding holds_finding(const std::vector<Hold>& holds, bool left_out, bool speed_is_known);

}  // namespace stickslip::analysis
