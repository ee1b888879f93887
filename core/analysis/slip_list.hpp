/// \file
/// Final selection of the slips of a test, by criteria that need all of its falls.
#pragma once

#include <filesystem>

#include "core/base/long_column.hpp"
#include "core/detect/fall_finder.hpp"

namespace stickslip::analysis {

/// Falls that are slips: `falls`, already selected one by one by detect::SlipRule, without
/// - falls before the force has been loaded and after it is unloaded: two spikes at rest;
/// - falls in the hold after a pull, where the force does not climb;
/// - falls too quick for the oscillation that the others show: steps between spikes;
/// - the unloading itself, the last fall, which ends where the loading began though the slips do not;
/// Two falls are joined if the time from trough to next peak is less than a quarter of an oscillation: they
/// are one slip, split by a disturbance. Fewer than three falls are returned unchanged.
/// \param scratch  folder for a long list; empty: memory.
[[nodiscard]] base::LongColumn<detect::Fall> kept_slips(base::LongColumn<detect::Fall> falls,
                                                        const std::filesystem::path& scratch = {});

}  // namespace stickslip::analysis
