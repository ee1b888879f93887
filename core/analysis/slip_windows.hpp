/// \file
/// Windows: the scans that are fitted as one slip.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/analysis/slip_estimator.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/estimate/slip_fit.hpp"
#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

/// Index of the pull that a slip belongs to, by the speed of Trace::belt, planned or measured; 0 if that is
/// constant.
[[nodiscard]] std::size_t pull_of(const estimate::Trace& trace, const detect::Fall& slip);
/// Whether slip i is the first of `slips`, or lies in another pull than the slip before: the belt stopped or
/// went back between them.
[[nodiscard]] bool begins_a_pull(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                                 std::size_t i);
/// Whether two slips lie in different pulls and the belt only stood still before the later one; false if the
/// carriage went back.
[[nodiscard]] bool is_held_between(const estimate::Trace& trace, const detect::Fall& before,
                                   const detect::Fall& after);
/// When the contact began to rest before a slip that follows a hold, s on the trace's time axis. It is the
/// trough of the slip before, near which that was captured; or the stop of the belt, if that came more than
/// two cycles after the trough: the sled slid on until then.
/// \param slip  the first after a hold. \param trough_s  time of the trough of the slip before.
/// \param cycle_s  length of the cycle that ended at the peak of the slip before; 0 if unknown: then the
/// later of trough and stop counts.
[[nodiscard]] double rests_from_s(const estimate::Trace& trace, const detect::Fall& slip, double trough_s,
                                  double cycle_s);
/// Whether a break lies between slip i − 1 and slip i, or in the rise to the first slip.
[[nodiscard]] bool follows_a_break(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                                   std::size_t i);
/// The first scan after the pull in which the slip lies; the size of the trace if there is none, as at
/// constant speed.
[[nodiscard]] std::size_t end_of_pull(const estimate::Trace& trace, const detect::Fall& slip);
/// Whether the pull ended during the last slip: the force after its trough does not rise as in a stick. True
/// also of a free oscillation, which does not rise either. False with fewer than four slips, or if the trace
/// ends or breaks too early to show that.
[[nodiscard]] bool pull_ended_in_last_slip(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                                           const model::SharedParameters& shared);

/// Scan half way along the rise between two slips: the end of the first one's window, the beginning of the
/// second one's.
[[nodiscard]] std::size_t boundary(const detect::Fall& before, const detect::Fall& after);
/// First scan of the window of a pull's first slip: above the rounded start of the loading, a fifth of the
/// rise. A sled that lags behind the belt's start has caught up after v/(K g), at c = r²/(ω₀² K); the window
/// begins at twice that if it is higher. It holds no break, and no scan before the pull.
[[nodiscard]] std::size_t start_of_loading(const estimate::Trace& trace, const detect::Fall& first,
                                           const model::SharedParameters& shared);

/// Fills estimates.windows, with first guesses of their slips, and window_of_slip from estimates.ends.
void lay_windows(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                 const model::SharedParameters& shared, SlipEstimates& estimates);
/// Whether there are windows and each has at least four usable scans, one more than the slip's parameters.
[[nodiscard]] bool windows_suffice(const estimate::Trace& trace,
                                   const std::vector<estimate::SlipWindow>& windows);

}  // namespace stickslip::analysis
