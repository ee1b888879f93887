/// \file
/// Findings on results that no friction tester gives.
#pragma once

#include <optional>

#include "core/analysis/results.hpp"

namespace stickslip::pipeline {

/// Limits of a plausible coefficient, wider than any friction of paper, film, textile or rubber. A wrong unit
/// is off by 9.8 or by 1000.
inline constexpr double kLowestCoefficient = 0.01;
inline constexpr double kHighestCoefficient = 5.0;
/// Limits of a plausible sled mass, wider than any sled of a friction tester: the standards have 0.2 kg (ISO
/// 8295) to 2.331 kg.
inline constexpr double kLightestPlausibleSled_kg = 0.005;
inline constexpr double kHeaviestPlausibleSled_kg = 20.0;

/// The finding for a sled mass outside the limits; nullopt if it is within, or at one of them.
[[nodiscard]] std::optional<base::Finding> sled_finding(double sled_mass_kg);

/// Adds a finding for a traditional static or kinetic coefficient, and for a sled mass, outside the limits: a
/// wrong unit, gain or mass looks so.
void add_plausibility(analysis::TestResults& results, double sled_mass_kg);

}  // namespace stickslip::pipeline
