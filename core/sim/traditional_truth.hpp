/// \file
/// Traditional coefficients of the noise-free, continuous force.
#pragma once

#include <cstdint>
#include <optional>

#include "core/model/method.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::sim {

struct TraditionalTruth {
  std::optional<double>
      static_coefficient;  ///< Maximum number method.static_slip after the first slip onset.
  std::optional<double> kinetic_coefficient;  ///< Mean after the first maximum, over cycles or travel.
};

/// \param scene     oscillates, and has a pull.
/// \param seed      of the run.
/// \param onset_s   first slip onset.
/// \param pull_speed_m_per_s  turns the method's travel into time.
/// \return a coefficient is nullopt if the pull is too short for it.
[[nodiscard]] TraditionalTruth traditional_truth(const Scene& scene, std::uint64_t seed, double onset_s,
                                                 const model::Method& method, double pull_speed_m_per_s);

}  // namespace stickslip::sim
