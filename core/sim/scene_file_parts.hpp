/// \file
/// Readers of a scene's effects, one function for each stage that has a file of its own. They set
/// what is listed; mistakes stay in the settings until finish().
#pragma once

#include "core/base/settings.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::sim {

// Limits of sense, not of the method: a value outside is taken for a slip of the pen.
inline constexpr double kLargestCoefficient = 10.0;
inline constexpr double kHighestVoltage_V = 1000.0;

/// \param effects  the table [effects]. \param scene  with tester, load cell and scan rate.
void read_signal_effects(base::Settings effects, Scene& scene);

}  // namespace stickslip::sim
