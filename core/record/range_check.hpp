/// \file
/// Range checks of scan indices and clocks read from untrusted files, so that their sums and differences
/// cannot overflow.
#pragma once

#include <cstdint>

#include "core/daq/clock_anchor.hpp"
#include "core/daq/gap.hpp"

namespace stickslip::record {

/// Largest scan index accepted: a double, and so a scan's time, is exact up to it. At 100 kHz an acquisition
/// reaches it in 2855 years.
inline constexpr daq::ScanIndex kLastScan = std::int64_t{1} << 53;

/// Returns its argument, or throws std::invalid_argument naming the value and the limits.
/// \{
daq::ScanIndex range_checked(daq::ScanIndex scan);
/// Checks first and last scan.
daq::Gap range_checked(const daq::Gap& gap);
/// Checks the scan, and that both clocks are ≥ 0: Linux cannot set them below.
daq::ClockAnchor range_checked(const daq::ClockAnchor& anchor);
/// \}

}  // namespace stickslip::record
