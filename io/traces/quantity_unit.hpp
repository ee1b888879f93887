/// \file
/// Units in which a trace may have its force.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/result.hpp"
#include "core/daq/board.hpp"

namespace stickslip::traces {

struct QuantityUnit {
  daq::RawQuantity quantity = daq::RawQuantity::kForce_N;
  double scale = 1.0;  ///< Value in N, V or 1 for one in this unit.
};

/// What the codes of an A/D converter mean: `--count-range` and `--volts-per-count`.
struct CountScale {
  std::int64_t lowest = 0;  ///< Code at the lower rail; negative where the converter counts from the middle.
  std::int64_t highest = 0;
  double volts_per_count = 0.0;  ///< 0 V is code 0.
};

/// Range of codes, "0..65535" or "-32768..32767". \param volts_per_count  positive. Errors: kUsage naming the
/// option, unless the codes rise and are at most 2^32.
[[nodiscard]] base::Result<CountScale> count_scale(std::string_view range, double volts_per_count);

/// N, mN, kN, gf, kgf, lbf, ozf …, V, mV, uV, counts, coefficient, percent. Errors: kUsage listing them.
[[nodiscard]] base::Result<QuantityUnit> quantity_unit(std::string_view unit);

/// What --unit takes for a unit of a heading or a cell: "gf" for "g" or "grams", in which a force is shown as
/// a mass. Another unit if there is no such one: quantity_unit() tells.
[[nodiscard]] std::string force_unit(const std::string& unit);

}  // namespace stickslip::traces
