/// \file
/// First guesses of what a fit starts from, out of turning points and slopes.
#pragma once

#include <cstddef>
#include <span>

#include "core/detect/fall_finder.hpp"
#include "core/estimate/trace.hpp"
#include "core/model/slip_model.hpp"

namespace stickslip::analysis {

/// The scan nearest to a position between scans; the first if it lies before it.
[[nodiscard]] std::size_t scan_at(double position);
[[nodiscard]] double scans_per_s(const estimate::Trace& trace);

/// Level from which the force rises to the peak: the median about the turning point, which two spikes there
/// do not move.
[[nodiscard]] double level_before(const estimate::Trace& trace, const detect::Fall& fall);

/// Median slope of the rises to the peaks: half of a rise is stick, where there is any.
[[nodiscard]] double slope_of_sticks(const estimate::Trace& trace, std::span<const detect::Fall> slips);

/// ω from half periods, γ of the paper's tester, the stick rate from the loading, or the sticks where the
/// trace begins later. \param slips  not empty.
[[nodiscard]] model::SharedParameters first_guess(const estimate::Trace& trace,
                                                  std::span<const detect::Fall> slips);
/// One slip's own parameters from its peak and trough.
[[nodiscard]] model::SlipParameters first_guess(const estimate::Trace& trace, const detect::Fall& slip,
                                                const model::SharedParameters& shared);

/// Stick rate at the peak of a slip, 1/s.
[[nodiscard]] double rate_at(const estimate::Trace& trace, const detect::Fall& slip,
                             const model::SharedParameters& shared);

/// Where a slip is at its lowest, in scans: half an oscillation after its peak. What follows may be flat (a
/// belt that stops), and its lowest scan anywhere.
[[nodiscard]] double trough_at(const estimate::Trace& trace, const detect::Fall& slip,
                               const model::SharedParameters& shared);

/// S − K of a slip by its amplitude, [2]: median of those that moved faster than the belt.
[[nodiscard]] double typical_delta_mu(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                                      const model::SharedParameters& shared);

}  // namespace stickslip::analysis
