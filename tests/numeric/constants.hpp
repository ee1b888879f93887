/// \file
/// What the tests of this folder agree on.
#pragma once

#include <limits>

namespace stickslip::numeric {

/// ε: between 1 and the next double.
inline constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// Of the scans, unless a test says another.
inline constexpr double kRate_Hz = 350.0;
/// Of the belt: 12 in/min, in m/s.
inline constexpr double kSpeed = 0.00508;

}  // namespace stickslip::numeric
