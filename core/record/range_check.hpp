/// \file
/// Range checks of scan indices and clocks read from untrusted files, so that their sums and differences
/// cannot overflow.
#pragma once

#include <cstdint>

#include "core/daq/clock_anchor.hpp"
#include "core/daq/gap.hpp"

namespace stickslip::record {

/// Largest scan index accepted, 2⁵³: a double holds each whole number up to it exactly. At 100 kHz an
/// acquisition reaches it in 2854 years.
inline constexpr daq::ScanIndex kLastScan = std::int64_t{1} << 53;

/// Returns its argument, or throws std::invalid_argument naming the value that is out of range.
/// \{
/// Accepts 0 … kLastScan.
daq::ScanIndex range_checked(daq::ScanIndex scan);
/// Accepts a gap with first ≥ 0, count ≥ 0 and first + count ≤ kLastScan.
daq::Gap range_checked(const daq::Gap& gap);
/// Accepts an anchor with a scan in 0 … kLastScan and both clocks ≥ 0: Linux cannot set them below.
daq::ClockAnchor range_checked(const daq::ClockAnchor& anchor);
/// \}

}  // namespace stickslip::record
