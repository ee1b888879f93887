/// \file
/// The slips of a whole test, seen together: what looked like a slip when it came and is none.
#pragma once

#include <vector>

#include "core/friction/fall_finder.hpp"

namespace stickslip::friction {

/// Takes out of `falls`, which the rule of single slips has let pass,
/// - falls before the force has been loaded and after it is unloaded: two spikes at rest;
/// - falls in the hold after a pull, where the force does not climb;
/// - the unloading itself, the last fall, which ends where the loading began though the slips do not;
/// and joins two falls that are closer than a quarter of an oscillation: one slip, split by what disturbed
/// it.
void keep_slips(std::vector<Fall>& falls);

}  // namespace stickslip::friction
