/// \file
/// A test method as one line in a record, so that the record alone is enough to repeat it.
#pragma once

#include <string>
#include <string_view>

#include "core/base/result.hpp"
#include "core/model/method.hpp"

namespace stickslip::record {

/// "penner-1995 kinetic_cycles=10", "iso-8295 kinetic_travel=0:0.06 sled_mass=0.2~0.002 sled_area=0.004
/// speed=0.0016666666666666668 replicates=3": the name, then settings in SI units as the shortest texts that
/// read back to the same values. static_slip=1 is not written; "~" stands before a tolerance.
[[nodiscard]] std::string method_text(const model::Method& method);

/// Reads what method_text() wrote; an empty text is the default method. Error: kUsage.
[[nodiscard]] base::Result<model::Method> method_from_text(std::string_view text);

}  // namespace stickslip::record
