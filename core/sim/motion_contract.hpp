/// \file
/// What every solver may take for granted about a motion.
#pragma once

#include "core/sim/motion.hpp"

namespace stickslip::sim {

/// Contract: every number is in the range that its comment in motion.hpp names, and finite (a segment of the
/// belt may last for ever). Out of range no branch of a motion means anything. Scenes are checked, with an
/// error for people, where they are read.
void expect_sound(const Motion& motion);

}  // namespace stickslip::sim
