/// \file
/// What the traditional rule would read from the force itself: no noise, no converter, no scans.
#pragma once

#include <cstdint>
#include <optional>

#include "core/friction/method.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::sim {

struct TraditionalTruth {
  std::optional<double> static_coefficient;   ///< First maximum after the first slip onset.
  std::optional<double> kinetic_coefficient;  ///< Mean over the next cycles, from maximum to maximum.
};

/// \param scene     oscillates, and has a pull.
/// \param seed      of the run.
/// \param onset_s   first slip onset.
/// \return without the number that the pull is too short for.
[[nodiscard]] TraditionalTruth traditional_truth(const Scene& scene, std::uint64_t seed, double onset_s,
                                                 const friction::Method& method);

}  // namespace stickslip::sim
