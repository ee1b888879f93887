/// \file
/// What a file may claim of scans and clocks. Who wrote it is not known; so it is asked where a claim is
/// read, and differences and sums of what was read cannot overflow.
#pragma once

#include <cstdint>

#include "core/daq/clock_anchor.hpp"
#include "core/daq/gap.hpp"

namespace stickslip::record {

/// The last whole number up to which a double, and so the time of a scan, tells each from the next. At 100
/// kHz an acquisition gets there in 2855 years.
inline constexpr daq::ScanIndex kLastScan = std::int64_t{1} << 53;

/// Throws std::invalid_argument naming the value and the limits, or gives back what it was given.
/// \{
daq::ScanIndex possible(daq::ScanIndex scan);
/// It begins at a possible scan and ends at one.
daq::Gap possible(const daq::Gap& gap);
/// Neither clock of Linux can be set below zero.
daq::ClockAnchor possible(const daq::ClockAnchor& anchor);
/// \}

}  // namespace stickslip::record
