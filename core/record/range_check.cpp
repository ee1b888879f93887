#include "core/record/range_check.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace stickslip::record {

daq::ScanIndex range_checked(daq::ScanIndex scan) {
  if (scan < 0 || scan > kLastScan)
    throw std::invalid_argument(fmt::format("scan {} lies outside of 0 to {}", scan, kLastScan));
  return scan;
}

daq::Gap range_checked(const daq::Gap& gap) {
  range_checked(gap.first);
  if (gap.count < 0 || gap.count > kLastScan - gap.first) {
    throw std::invalid_argument(fmt::format("a gap of {} scans from scan {} ends outside of 0 to {}",
                                            gap.count, gap.first, kLastScan));
  }
  return gap;
}

daq::ClockAnchor range_checked(const daq::ClockAnchor& anchor) {
  range_checked(anchor.scan);
  if (anchor.monotonic_ns < 0 || anchor.realtime_ns < 0) {
    throw std::invalid_argument(
        fmt::format("no clock shows {} ns and {} ns: below zero", anchor.monotonic_ns, anchor.realtime_ns));
  }
  return anchor;
}

}  // namespace stickslip::record
