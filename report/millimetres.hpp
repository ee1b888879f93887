/// \file
/// Conversion to millimetres, which reports and pictures use; the rest of the program uses metres.
#pragma once

namespace stickslip::report {

inline constexpr double kMillimetresPerMetre = 1e3;

}  // namespace stickslip::report
