/// \file
/// First guesses of a fit's parameters, from turning points and slopes.
#pragma once

#include <cstddef>
#include <span>

#include "core/detect/fall_finder.hpp"
#include "core/estimate/trace.hpp"
#include "core/model/slip_model.hpp"

namespace stickslip::analysis {

/// The scan nearest to a fractional position; scan 0 for a negative one.
[[nodiscard]] std::size_t scan_at(double position);
/// Mean scan rate of the trace without its gaps. \param trace  of two scans at least.
[[nodiscard]] double scans_per_s(const estimate::Trace& trace);

/// Level from which the force rises to the peak: the median of the scans about the turning point, which a
/// single spike does not affect.
[[nodiscard]] double level_before(const estimate::Trace& trace, const detect::Fall& fall);

/// Stick rate at the largest belt speed, 1/s: median slope of the rises, each between 30 and 70 % of its
/// height, where the sled sticks if it does at all. A rise is left out if the belt does not pull at the
/// middle of its time; if all are, the slope of the first rise counts as it is.
/// \param slips  not empty.
[[nodiscard]] double slope_of_sticks(const estimate::Trace& trace, std::span<const detect::Fall> slips);

/// ω from half periods, the typical γ/2ω, and the stick rate from the loading, or from the sticks if the
/// trace begins after the loading or the pull speed changes.
/// \param slips  not empty.
[[nodiscard]] model::SharedParameters first_guess(const estimate::Trace& trace,
                                                  std::span<const detect::Fall> slips);
/// Onset, S and K of one slip from its peak and trough; S and K without Trace::drift.
[[nodiscard]] model::SlipParameters first_guess(const estimate::Trace& trace, const detect::Fall& slip,
                                                const model::SharedParameters& shared);

/// Stick rate at the peak of a slip, 1/s.
[[nodiscard]] double rate_at(const estimate::Trace& trace, const detect::Fall& slip,
                             const model::SharedParameters& shared);

/// Position of a slip's trough in scans: Fall::trough_at, but at most 1.15 half periods after the peak. After
/// a stop of the belt the force is flat, and its lowest scan may lie anywhere.
[[nodiscard]] double trough_at(const estimate::Trace& trace, const detect::Fall& slip,
                               const model::SharedParameters& shared);

/// Typical S − K: the median of √(amplitude² − (r/ω)²) [2] over the slips whose amplitude, half the drop,
/// exceeds r/ω, the belt's part; the largest amplitude if none does.
[[nodiscard]] double typical_delta_mu(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                                      const model::SharedParameters& shared);

}  // namespace stickslip::analysis
