/// \file
/// Scan index, the time base of all results.
#pragma once

#include <cstdint>

namespace stickslip::base {

/// Number of a scan since the acquisition started; time = index / granted rate. It never repeats
/// and never runs backwards; a jump is a gap.
using ScanIndex = std::int64_t;

}  // namespace stickslip::base
