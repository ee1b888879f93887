/// \file
/// Reports and pictures speak of millimetres, the rest of the program of metres.
#pragma once

namespace stickslip::report {

inline constexpr double kMillimetresPerMetre = 1e3;

}  // namespace stickslip::report
