/// \file
/// How a laboratory turns a trace into two traditional numbers.
#pragma once

#include <string>

namespace stickslip::friction {

/// Defaults: "the first peak as the static COF, and the average of about the next 10 cycles as the
/// kinetic COF" [Penner 1995, Experimental].
struct Method {
  std::string name = "penner-1995";
  int kinetic_cycles = 10;  ///< Cycles after the first peak that the kinetic coefficient averages, ≥ 1.
};

}  // namespace stickslip::friction
