/// \file
/// Holds of a slide-hold-slide test: the belt stands still while the sled rests, then pulls on. The contact
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

/// An interval in which the belt stands still, on the trace's time axis.
struct Hold {
  double stop_s = 0.0;
  double go_s = 0.0;  ///< > stop_s
};

/// Holds between slips. In a hold the force takes at least three times as long from a trough to the next peak
/// as it needs at the rate of the other rises, and stands still in between, but for creep. Stop and go are
/// where the level of the hold meets the two rises; without a rise before the hold the belt stopped at the
/// trough. A sled that slides as smoothly looks the same.
/// \param slips  in the order of time.
/// \param sigma  noise of a scan.
/// \return in the order of time; none across a break, and none for fewer than five slips.
[[nodiscard]] std::vector<Hold> find_holds(const estimate::Trace& trace,
                                           const base::LongColumn<detect::Fall>& slips, double sigma);

/// Pull speed of a belt of one speed that stands still in the holds.
/// \param begin_s  time 0 of the course, on the trace's time axis; not after the first hold.
/// \param holds  in the order of time.
/// \return nullopt where PullSpeed::make() refuses it: the speed is not > 0, or there are more than 24 999
///         holds.
[[nodiscard]] std::optional<model::PullSpeed> course_with_holds(double pull_speed_m_per_s, double begin_s,
                                                                const std::vector<Hold>& holds);

/// Finding kHolds: number and duration of the holds, and what they do to the results.
/// \param holds  not empty.
/// \param left_out  the slips after them are not in S and S − K.
/// \param speed_is_known  if it is not, and the slips are not left out, the text asks for the pull speed.
[[nodiscard]] base::Finding holds_finding(const std::vector<Hold>& holds, bool left_out, bool speed_is_known);

}  // namespace stickslip::analysis
