/// \file
/// Clock anchor: a scan index with the clock readings at that scan.
#pragma once

#include <cstdint>

#include "core/base/scan_index.hpp"

namespace stickslip::daq {

/// Readings of base::Clock when a scan was read, from which the true scan rate is fitted.
struct ClockAnchor {
  base::ScanIndex scan = 0;
  std::int64_t monotonic_ns = 0;
  std::int64_t realtime_ns = 0;

  bool operator==(const ClockAnchor&) const = default;
};

}  // namespace stickslip::daq
