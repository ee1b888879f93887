/// \file
#pragma once

#include <limits>

namespace stickslip::friction {

/// A number that nobody knows.
inline constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();

}  // namespace stickslip::friction
