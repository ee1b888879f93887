/// \file
/// Contract of a motion that every solver relies on.
#pragma once

#include "core/sim/motion.hpp"

namespace stickslip::sim {

/// Checks the contract: every number is finite and in the range stated in motion.hpp; only a belt segment may
/// last infinitely. Scenes are checked when read, with error messages.
void expect_sound(const Motion& motion);

}  // namespace stickslip::sim
