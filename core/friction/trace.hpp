/// \file
/// The scans of one test as the estimators see them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stickslip::friction {

/// Columns of equal length, in the order of time.
struct Trace {
  std::vector<double> time_s;        ///< (scan index − first index of the record) / granted rate.
  std::vector<double> value;         ///< Coefficient; a spike is replaced by the median around it.
  std::vector<std::uint8_t> usable;  ///< 0 for a spike or a saturated scan: left out of fits.

  [[nodiscard]] std::size_t size() const noexcept { return value.size(); }
};

}  // namespace stickslip::friction
