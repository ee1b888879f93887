#include "core/detect/scan_rows.hpp"

#include <cmath>

namespace stickslip::detect {
namespace {

/// Until something is known of the oscillation, rows are so long that those kept reach back so far.
constexpr double kFirstReach_s = 0.5;
/// Scans of a row at most, for numbers that are none.
constexpr double kMostScans = 1e6;

}  // namespace

ScanRows::ScanRows(double scan_s) noexcept
    : scan_s_(scan_s),
      scans_(static_cast<std::size_t>(
          std::clamp(std::ceil(kFirstReach_s / (static_cast<double>(kMost) * scan_s)), 1.0, kMostScans))) {}

void ScanRows::restart(std::size_t scans) noexcept {
  scans_ = scans;
  in_row_ = 0;
  sum_ = 0.0;
  usable_ = true;
  count_ = 0;
}

}  // namespace stickslip::detect
