/// \file
#pragma once

#include <limits>

namespace stickslip::base {

/// NaN, which marks an unknown value.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace stickslip::base
