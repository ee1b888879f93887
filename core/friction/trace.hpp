/// \file
/// The scans of one test as the estimators see them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/long_column.hpp"

namespace stickslip::friction {

/// Columns of equal length, in the order of time.
struct Trace {
  base::LongColumn<double> time_s;        ///< (scan index − first index of the record) / granted rate.
  base::LongColumn<double> value;         ///< Coefficient; a spike is replaced by the median around it.
  base::LongColumn<std::uint8_t> usable;  ///< 0 for a spike or a saturated scan: left out of fits.

  [[nodiscard]] std::size_t size() const noexcept { return value.size(); }
};

}  // namespace stickslip::friction
