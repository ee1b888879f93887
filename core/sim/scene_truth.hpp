/// \file
/// Truth of a scene, with which its record is compared.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/model/method.hpp"
#include "core/model/truth.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::sim {

/// The truth about one repetition, with times in seconds after its first scan as a record has them:
/// scans over the nominal rate. What has no place in the record is in true seconds (the frequency).
///
/// Regime over the pull: stick-slip if each slip that began by giving way ended in sticking, ring-down
/// if none did, mixed otherwise; a slip that the end of the pull interrupts is ignored; a sled that slides
/// because of a fast start of the belt has not stuck. Steady-sliding if the slip cannot oscillate; undecided
/// without a slip. Frequency: of the onsets if there are two, else ω/2π of the ring-down. Amplitude: half the
/// range of the first slip in closed form [17], with zero as the least force of a one-way coupling; of a
/// motion without closed forms that of the force itself. What rate-and-state friction calls a slip, and which
/// S and K it then has: rate_and_state_motion.hpp.
///
/// \param method  by which the traditional coefficients are read from the force.
/// \param scratch_folder  of the tables of a long test (base::LongColumn), which throw std::system_error
///        then; empty: they are in memory.
[[nodiscard]] model::TestTruth scene_truth(const Scene& scene, double nominal_rate_Hz, std::uint64_t seed,
                                           const model::Method& method = {},
                                           const std::filesystem::path& scratch_folder = {});

}  // namespace stickslip::sim
