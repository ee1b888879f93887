/// \file
/// Check of a motion before it is solved.
#pragma once

#include "core/sim/motion.hpp"

namespace stickslip::sim {

/// Aborts unless γ ≥ 0 and ω₀² > 0 of the oscillator are finite, and S and K, gravity, start-up slack, belt
/// segments and the numbers of kinetic_drift are in the ranges stated in motion.hpp. A segment may last
/// infinitely. Not checked here: whether f of the drift stays ≥ 0, and the settings of `paper`,
/// velocity_dependence and rate_and_state. Scenes from files have been checked, with error messages.
void expect_sound(const Motion& motion);

}  // namespace stickslip::sim
