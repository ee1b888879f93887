/// \file
/// A moment of a simulation: whole scans and a fraction of a scan period. The fraction keeps its
/// sixteen digits however long the simulation runs, which one double of seconds would not.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

namespace stickslip::sim {

/// Moment of a simulation; {0, 0.0} is scan 0.
struct ScanTime {
  std::int64_t scan = 0;
  double fraction = 0.0;  ///< 0 ≤ fraction < 1

  /// The moment `periods` ≥ 0 scan periods later; kForEver if that is beyond the largest index.
  [[nodiscard]] ScanTime later(double periods) const noexcept {
    const double sum = fraction + periods;
    const double whole = std::floor(sum);
    constexpr std::int64_t kEnd = std::numeric_limits<std::int64_t>::max();
    if (!(whole < static_cast<double>(kEnd - scan))) return {kEnd, 0.0};
    return {scan + static_cast<std::int64_t>(whole), sum - whole};
  }

  /// Scan periods from `start` to this.
  [[nodiscard]] double periods_since(const ScanTime& start) const noexcept {
    return static_cast<double>(scan - start.scan) + (fraction - start.fraction);
  }

  auto operator<=>(const ScanTime&) const = default;
};

/// The latest moment: never.
inline constexpr ScanTime kForEver{std::numeric_limits<std::int64_t>::max(), 0.0};

}  // namespace stickslip::sim
