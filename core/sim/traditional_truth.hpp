/// \file
/// Static and kinetic coefficient by a traditional method, from the noise-free, continuous force.
#pragma once

#include <cstdint>
#include <optional>

#include "core/model/method.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::sim {

struct TraditionalTruth {
  /// The force at its n-th local maximum after the first slip onset, n = method.static_slip.
  std::optional<double> static_coefficient;
  /// Mean of the force over method.kinetic_travel after its first maximum; if that is not set, over
  /// method.kinetic_cycles cycles from the first maximum on, from maximum to maximum.
  std::optional<double> kinetic_coefficient;
};

/// Reads the force by the method, at 2000 points in each free period.
/// \param scene    with an underdamped oscillator and a pull (pull_of()).
/// \param seed     of the run.
/// \param onset_s  first slip onset, true seconds after the start of the scene.
/// \param pull_speed_m_per_s  turns method.kinetic_travel into time; > 0 if that is set.
/// \return a coefficient is nullopt if the pull ends before the maxima or the travel that it needs.
/// \throws std::runtime_error if CVODE fails (NumericSolver).
[[nodiscard]] TraditionalTruth traditional_truth(const Scene& scene, std::uint64_t seed, double onset_s,
                                                 const model::Method& method, double pull_speed_m_per_s);

}  // namespace stickslip::sim
