/// \file
/// Truth of a scene, with which its record is compared.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/model/method.hpp"
#include "core/model/truth.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::sim {

/// The truth about one repetition. Times of modes and cycles are seconds after its first scan as a record has
/// them: scan index over nominal rate. Frequencies and speeds are true ones. Slips are those that begin
/// because the contact gives way; what that means for rate-and-state friction: rate_and_state_motion.hpp.
/// Modes and cycles cover the whole repetition; all else counts only slips that begin before the pull ends.
///
/// Regime over the pull: stick-slip if each slip ended in sticking, ring-down if none did, mixed if some did;
/// undecided if no slip counts. One that the end of the pull interrupts counts only if it has lasted longer
/// than two free periods and than any captured slip before; then it did not stick. Sliding that ends a stick
/// without giving way, as at a jump of the belt's speed, counts as a slip that did not stick, if it lasts
/// that long.
///
/// Pull speed: that of the belt at the first onset; without a slip steady_pull_speed_m_per_s(), or else 0.
/// Frequency: mean one of the onsets if there are two or more; ω/2π if there is one and the regime is
/// ring-down or mixed; else absent. Amplitude: half the range of the first slip in closed form [17] at the
/// onset's K and belt speed, with zero as the least force of a one-way coupling; of a motion without closed
/// forms that of the force itself; absent without a slip. Traditional coefficients: TraditionalTruth; absent
/// without a slip. Without a pull (pull_of()) all these are absent, 0 or undecided.
///
/// \param scene  with an underdamped oscillator, as scene files have it.
/// \param seed    of the repetition.
/// \param method  by which the traditional coefficients are read from the force.
/// \param scratch_folder  of the tables of a long test (base::LongColumn); empty: they are in memory.
/// \throws std::system_error if a table in scratch_folder fails; std::runtime_error if CVODE fails
///         (NumericSolver).
[[nodiscard]] model::TestTruth scene_truth(const Scene& scene, double nominal_rate_Hz, std::uint64_t seed,
                                           const model::Method& method = {},
                                           const std::filesystem::path& scratch_folder = {});

}  // namespace stickslip::sim
