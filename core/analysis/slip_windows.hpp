/// \file
/// Which scans belong to which slip.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/analysis/slip_estimator.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/estimate/slip_fit.hpp"
#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

/// Number of the pull that a slip belongs to, by the planned course of the speed; 0 if it is constant.
[[nodiscard]] std::size_t pull_of(const estimate::Trace& trace, const detect::Fall& slip);
/// Slip i is the first one of the test, or after the belt had stopped.
[[nodiscard]] bool begins_a_pull(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                                 std::size_t i);
/// What happened between slip i − 1 and slip i, or in the rise to the first one, is not known.
[[nodiscard]] bool follows_a_break(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                                   std::size_t i);
/// The first scan after the pull in which the slip lies.
[[nodiscard]] std::size_t end_of_pull(const estimate::Trace& trace, const detect::Fall& slip);
/// The pull ended while the last slip was on its way: what follows its trough does not climb as a stick does.
/// Where the trace ends before that can be seen, it counts as any other.
[[nodiscard]] bool pull_ended_in_last_slip(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                                           const model::SharedParameters& shared);

/// Half way along the rise between two slips: scans before it belong to the first, after it to the second.
[[nodiscard]] std::size_t boundary(const detect::Fall& before, const detect::Fall& after);
/// Where the window of a pull's first slip begins: above the rounded start of the loading. A sled that the
/// belt's start has left behind has caught up after v/(K g) at c = r²/(ω₀² K); twice that is taken.
[[nodiscard]] std::size_t start_of_loading(const estimate::Trace& trace, const detect::Fall& first,
                                           const model::SharedParameters& shared);

/// Fills estimates.windows and window_of_slip from estimates.ends.
void lay_windows(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                 const model::SharedParameters& shared, SlipEstimates& estimates);
/// Each slip has scans enough for its own parameters and one to spare.
[[nodiscard]] bool windows_suffice(const estimate::Trace& trace,
                                   const std::vector<estimate::SlipWindow>& windows);

}  // namespace stickslip::analysis
