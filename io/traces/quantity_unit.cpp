#include "io/traces/quantity_unit.hpp"

#include <fmt/format.h>

#include "core/base/quantity.hpp"
#include "core/base/wording.hpp"

namespace stickslip::traces {

base::Result<QuantityUnit> quantity_unit(std::string_view unit) {
  if (unit == "coefficient" || unit == "1") return QuantityUnit{daq::RawQuantity::kCoefficient, 1.0};
  if (unit == "cN") return QuantityUnit{daq::RawQuantity::kForce_N, 0.01};
  if (unit == "daN") return QuantityUnit{daq::RawQuantity::kForce_N, 10.0};
  if (unit == "percent" || unit == "%") return QuantityUnit{daq::RawQuantity::kCoefficient, 0.01};
  const std::string one = fmt::format("1 {}", unit);
  if (const auto force = base::parse_quantity(one, base::Dimension::kForce))
    return QuantityUnit{daq::RawQuantity::kForce_N, *force};
  if (const auto voltage = base::parse_quantity(one, base::Dimension::kVoltage))
    return QuantityUnit{daq::RawQuantity::kVolts, *voltage};
  return base::usage_error(
      "--unit: \"{}\" is no unit of force; allowed: N, mN, cN, daN, kN, gf, kgf, lbf, ozf, V, mV, "
      "coefficient, "
      "percent{}",
      base::one_line(unit, 20),
      unit == "g" || unit == "kg" ? fmt::format(". A force shown in {} is in {}f", unit, unit) : "");
}

}  // namespace stickslip::traces
