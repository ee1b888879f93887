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

/// Index of the pull that a slip belongs to, by the plan of the speed; 0 if the speed is constant.
[[nodiscard]] std::size_t pull_of(const estimate::Trace& trace, const detect::Fall& slip);
/// Whether slip i is the first of the test, or the first after a stop of the belt.
[[nodiscard]] bool begins_a_pull(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                                 std::size_t i);
/// Whether the belt stood still between two slips.
[[nodiscard]] bool is_held_between(const estimate::Trace& trace, const detect::Fall& before,
                                   const detect::Fall& after);
/// When the rest before a slip after a hold began. How the slip before ended is not known: its trough is near
/// its capture, unless the sled slid on until the belt stopped, for longer than two cycles.
/// \param trough_s  of the slip before. \param cycle_s  from the peak before that one's to its; 0: unknown.
[[nodiscard]] double rests_from_s(const estimate::Trace& trace, const detect::Fall& slip, double trough_s,
                                  double cycle_s);
/// Whether a break lies between slip i − 1 and slip i, or in the rise to the first slip.
[[nodiscard]] bool follows_a_break(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                                   std::size_t i);
/// The first scan after the pull in which the slip lies.
[[nodiscard]] std::size_t end_of_pull(const estimate::Trace& trace, const detect::Fall& slip);
/// Whether the pull ended during the last slip: the force after its trough does not rise as in a stick. False
/// if the trace ends too early to show that.
[[nodiscard]] bool pull_ended_in_last_slip(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                                           const model::SharedParameters& shared);

/// Scan half way along the rise between two slips: the window of the first ends there, that of the second
/// begins.
[[nodiscard]] std::size_t boundary(const detect::Fall& before, const detect::Fall& after);
/// First scan of the window of a pull's first slip: above the rounded start of the loading. A sled that lags
/// behind the belt's start has caught up after v/(K g), at c = r²/(ω₀² K); the window begins at twice that.
[[nodiscard]] std::size_t start_of_loading(const estimate::Trace& trace, const detect::Fall& first,
                                           const model::SharedParameters& shared);

/// Fills estimates.windows and window_of_slip from estimates.ends.
void lay_windows(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                 const model::SharedParameters& shared, SlipEstimates& estimates);
/// Whether each window has at least four usable scans, one more than the slip's parameters.
[[nodiscard]] bool windows_suffice(const estimate::Trace& trace,
                                   const std::vector<estimate::SlipWindow>& windows);

}  // namespace stickslip::analysis
