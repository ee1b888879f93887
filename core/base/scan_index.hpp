/// \file
/// Scan index, the time base of all results.
#pragma once

#include <cstdint>

namespace stickslip::base {

/// Number of a scan, counted through an acquisition. It never repeats and never runs backwards; a jump is a
/// gap. The time between two scans is the difference of their indices over the granted rate.
using ScanIndex = std::int64_t;

}  // namespace stickslip::base
