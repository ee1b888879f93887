/// \file
/// A scan and the time at which it was taken, as well as that is known.
#pragma once

#include <cstdint>

#include "core/base/scan_index.hpp"

namespace stickslip::daq {

/// The clocks at a scan: from these the true scan rate is fitted.
struct ClockAnchor {
  base::ScanIndex scan = 0;
  std::int64_t monotonic_ns = 0;
  std::int64_t realtime_ns = 0;

  bool operator==(const ClockAnchor&) const = default;
};

}  // namespace stickslip::daq
