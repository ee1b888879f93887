/// \file
/// Units in which a trace may have its force.
#pragma once

#include <string_view>

#include "core/base/result.hpp"
#include "core/daq/board.hpp"

namespace stickslip::traces {

struct QuantityUnit {
  daq::RawQuantity quantity = daq::RawQuantity::kForce_N;
  double scale = 1.0;  ///< Value in N, V or 1 for one in this unit.
};

/// N, mN, kN, gf, kgf, lbf, ozf …, V, mV, uV, coefficient, percent. Errors: kUsage listing them.
[[nodiscard]] base::Result<QuantityUnit> quantity_unit(std::string_view unit);

}  // namespace stickslip::traces
