/// \file
/// The slips of a whole test, seen together: what looked like a slip when it came and is none.
#pragma once

#include <filesystem>

#include "core/base/long_column.hpp"
#include "core/detect/fall_finder.hpp"

namespace stickslip::analysis {

/// `falls`, which the rule of single slips has let pass, without
/// - falls before the force has been loaded and after it is unloaded: two spikes at rest;
/// - falls in the hold after a pull, where the force does not climb;
/// - falls too quick for the oscillation that the others show: steps between spikes;
/// - the unloading itself, the last fall, which ends where the loading began though the slips do not;
/// and with two falls joined that are closer than a quarter of an oscillation: one slip, split by what
/// disturbed it. \param scratch  folder for a long list; empty: memory.
[[nodiscard]] base::LongColumn<detect::Fall> kept_slips(base::LongColumn<detect::Fall> falls,
                                                        const std::filesystem::path& scratch = {});

}  // namespace stickslip::analysis
