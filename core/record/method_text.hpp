/// \file
/// A test method as one line in a record, so that the record alone is enough to repeat it.
#pragma once

#include <string>
#include <string_view>

#include "core/base/result.hpp"
#include "core/model/method.hpp"

namespace stickslip::record {

/// The name of the method, then its settings in SI units, each number as the shortest text that reads back to
/// the same value: "penner-1995 kinetic_cycles=10", "iso-8295 kinetic_travel=0:0.06 sled_mass=0.2~0.002
/// sled_area=0.004 speed=0.0016666666666666668 replicates=3". "~" stands before a tolerance. static_slip is
/// left out if it is 1, kinetic_cycles if there is a kinetic_travel, and a condition if it is open. Commas
/// separate the points of a speed course.
/// \param method  its name is not empty and has no space, else the text cannot be read back.
[[nodiscard]] std::string method_text(const model::Method& method);

/// Reads what method_text() wrote, with the settings in any order; an empty text is the default method. It
/// checks and ignores the setting `estimator` of version 0.1. Errors: kUsage without a name, for an unknown
/// setting or a bad value, and if there is neither kinetic_cycles nor kinetic_travel.
[[nodiscard]] base::Result<model::Method> method_from_text(std::string_view text);

}  // namespace stickslip::record
