/// \file
/// Amplitude of the first slip of a scene whose friction has no closed form.
#pragma once

#include <cstdint>

#include "core/sim/scene.hpp"

namespace stickslip::sim {

/// Half the range of the coefficient during one free period 2π/ω after the onset. It is taken from 2000
/// samples; of a sine it would be too small by at most a relative 1.3e-6.
/// \param scene  with an underdamped oscillator. \param seed  of the run.
/// \param onset_s  of the slip, true seconds after the start of the scene.
/// \throws std::runtime_error if CVODE fails (NumericSolver).
[[nodiscard]] double first_slip_amplitude(const Scene& scene, std::uint64_t seed, double onset_s);

}  // namespace stickslip::sim
