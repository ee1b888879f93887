/// \file
/// The two numbers of the tradition. [Penner 1995, Experimental]
#pragma once

#include <span>

#include "core/friction/fall_finder.hpp"
#include "core/friction/method.hpp"
#include "core/friction/results.hpp"
#include "core/friction/trace.hpp"

namespace stickslip::friction {

struct TraditionalCoefficients {
  Estimate static_coefficient;   ///< Largest scan of the first peak.
  Estimate kinetic_coefficient;  ///< Mean over the next method.kinetic_cycles cycles, peak to peak.
};

/// \param trace  not empty.
/// \param slips  in the order of time; with none there is no static coefficient, and the kinetic one is
///               the mean of the trace without its loading and unloading.
[[nodiscard]] TraditionalCoefficients traditional_coefficients(const Trace& trace,
                                                               std::span<const Fall> slips,
                                                               const Method& method);

}  // namespace stickslip::friction
