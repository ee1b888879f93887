/// \file
/// Readers of a scene's effects. They set the listed effects in the scene; errors are reported by
/// Settings::finish().
#pragma once

#include <string_view>

#include "core/base/settings.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::sim {

// Plausibility limits, not limits of the method: a value outside is taken for a typing error.
inline constexpr double kLargestCoefficient = 10.0;
inline constexpr double kHighestVoltage_V = 1000.0;

inline constexpr double kLongestPhase_s = 1e8;
inline constexpr double kFastestBelt_m_per_s = 10.0;

/// Reads the effects of the motion stage that move the belt, `startup_slack`, and the scene's duration.
/// \param scene_table  the whole scene. \param effects  the table [effects].
/// \param scene  with one_way_coupling.
void read_belt_effects(base::Settings scene_table, base::Settings effects, Scene& scene);

/// Reads `kinetic_drift`; refuses one whose K would become negative within the scene if no belt segment
/// halted.
/// \param effects  the table [effects]. \param scene  with K, belt and duration.
void read_kinetic_drift(base::Settings effects, Scene& scene);

/// Reads `scatter`, `first_peak`, `contact_ageing` and `onset_convention`.
/// \param effects  the table [effects].
void read_paper_effects(base::Settings effects, Scene& scene);

/// Reads `velocity_dependence`, `stribeck` and `rate_and_state`.
/// \param effects  the table [effects]. \param scene  with S and K.
void read_friction_laws(base::Settings effects, Scene& scene);

/// Reads the effects of the transducer stage. \param effects  the table [effects].
/// \param scene  with the scan rate.
void read_transducer_effects(base::Settings effects, Scene& scene);

/// Reads the effects of the sampling stage. \param effects  the table [effects].
/// \param scene  with the scan rate.
void read_sampling_effects(base::Settings effects, Scene& scene);

/// Reads the effects of the signal stage. \param effects  the table [effects].
/// \param scene  with tester, load cell and scan rate.
void read_signal_effects(base::Settings effects, Scene& scene);

/// Whether the effect is listed. Registers its name for the message about unknown effects.
[[nodiscard]] inline bool lists(base::Settings& effects, std::string_view name) {
  (void)effects.table(name);
  return effects.has(name);
}

}  // namespace stickslip::sim
