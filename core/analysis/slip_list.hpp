/// \file
/// Final selection of the slips of a test, by criteria that need all of its falls.
#pragma once

#include <filesystem>

#include "core/base/long_column.hpp"
#include "core/detect/fall_finder.hpp"

namespace stickslip::analysis {

/// Falls that are slips: `falls`, already selected one by one by detect::SlipRule, without
/// 1. falls at the beginning with a peak below a quarter of the usual load, as two spikes at rest make; but
///    not the first slips of a trace that begins in mid-test;
/// 2. falls at either end down to the unloaded level while the other slips end above it, as the unloading;
/// 3. falls at the end, in the hold after a pull, where the force does not climb;
/// 4. falls whose duration is much less than the median one, as steps between spikes make.
/// Two falls are joined if the time from trough to next peak is less than a quarter of an oscillation: they
/// are one slip, split by a disturbance. Fewer than three falls are returned as they are; if 1 and 2 leave
/// fewer than three, the rest is not done.
/// \param scratch  folder for a long list; empty: memory.
[[nodiscard]] base::LongColumn<detect::Fall> kept_slips(base::LongColumn<detect::Fall> falls,
                                                        const std::filesystem::path& scratch = {});

}  // namespace stickslip::analysis
