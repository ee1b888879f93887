/// \file
/// Known properties of the tester. [Penner 1995, Experimental]
#pragma once

#include <optional>

#include "core/model/pull_speed.hpp"
#include "core/model/transducer.hpp"

namespace stickslip::model {

/// Standard acceleration of gravity, m/s² [3rd CGPM, 1901].
inline constexpr double kStandardGravity_m_per_s2 = 9.80665;

/// γ/2ω of a sled on a spring where it is not known: that of the paper's tester. [Penner 1995, (19)]
inline constexpr double kTypicalGammaOver2Omega = 0.022;

/// The sled and its drive.
struct Tester {
  double sled_mass_kg = 2.331;  ///< [Penner 1995]
  double gravity_m_per_s2 = kStandardGravity_m_per_s2;
  std::optional<double> pull_speed_m_per_s;  ///< Nominal; nullopt if unknown.
  std::optional<double> stiffness_N_per_m;   ///< Of the coupling; nullopt if unknown.
  /// Pull speed over time, as planned; nullopt: that of the method, else constant but for holds that are
  /// found. What a speed channel measures counts before it.
  std::optional<PullSpeed> speed_course;
  Transducer transducer;  ///< Ideal if unknown.

  [[nodiscard]] double normal_load_N() const noexcept { return sled_mass_kg * gravity_m_per_s2; }
};

}  // namespace stickslip::model
