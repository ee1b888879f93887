/// \file
/// How a laboratory makes a test and turns its trace into two traditional numbers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/model/pull_speed.hpp"

namespace stickslip::model {

/// A number that a method asks for.
struct Nominal {
  double value = 0.0;
  std::optional<double>
      tolerance;  ///< Allowed difference, in the unit of the value; none: it is not checked.

  bool operator==(const Nominal&) const = default;
};

/// Belt travel after the first peak, 0 ≤ from < to.
struct TravelWindow {
  double from_m = 0.0;
  double to_m = 0.0;

  bool operator==(const TravelWindow&) const = default;
};

/// Defaults: "the first peak as the static COF, and the average of about the next 10 cycles as the
/// kinetic COF" [Penner 1995, Experimental].
struct Method {
  std::string name = "penner-1995";
  int static_slip = 1;      ///< The slip whose peak is the static coefficient, from 1.
  int kinetic_cycles = 10;  ///< Cycles after the first peak that the kinetic coefficient averages, ≥ 1.
  std::optional<TravelWindow> kinetic_travel;  ///< Instead of the cycles.

  // How the test is to be made; none where the method leaves it open.
  std::optional<Nominal> sled_mass_kg;
  std::optional<double> sled_area_m2;
  std::optional<Nominal> pull_speed_m_per_s;
  std::optional<PullSpeed>
      speed_course;  ///< Where the speed is meant to change; then instead of the nominal.
  std::optional<int> replicates;

  bool operator==(const Method&) const = default;
};

/// What of a test is not as its method asks, one line each: "pull speed 0.00508 m/s, iso-8295 asks
/// 0.00166667 ± 0.000166667 m/s". What the tester does not tell is not compared.
/// \param sled_mass_kg,pull_speed_m_per_s  of the test; none where not known.
[[nodiscard]] std::vector<std::string> departures(const Method& method, std::optional<double> sled_mass_kg,
                                                  std::optional<double> pull_speed_m_per_s);

}  // namespace stickslip::model
