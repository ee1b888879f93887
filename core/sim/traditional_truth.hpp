/// \file
/// What the traditional rule would read from the force itself: no noise, no converter, no scans.
#pragma once

#include <optional>

#include "core/friction/method.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::sim {

struct TraditionalTruth {
  std::optional<double> static_coefficient;   ///< First maximum after the first slip onset.
  std::optional<double> kinetic_coefficient;  ///< Mean over the next cycles, from maximum to maximum.
};

/// \param scene     oscillates, and has a constant-speed test.
/// \param onset_s   first slip onset.
/// \return without the number that the pull is too short for.
[[nodiscard]] TraditionalTruth traditional_truth(const Scene& scene, double onset_s,
                                                 const friction::Method& method);

}  // namespace stickslip::sim
