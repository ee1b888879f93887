/// \file
/// Test method: how a test is made and how its trace becomes the static and the kinetic coefficient.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/model/pull_speed.hpp"

namespace stickslip::model {

/// Required value of a test condition, with its tolerance.
struct Nominal {
  double value = 0.0;
  std::optional<double> tolerance;  ///< Allowed difference, in the unit of the value; nullopt: not checked.

  bool operator==(const Nominal&) const = default;
};

/// Interval of belt travel at the nominal pull speed; 0 ≤ from < to. It counts from the peak of the first
/// slip; without a slip, from the first scan of at least half the largest coefficient.
struct TravelWindow {
  double from_m = 0.0;
  double to_m = 0.0;

  bool operator==(const TravelWindow&) const = default;
};

/// A test method. Defaults: "the first peak as the static COF, and the average of about the next 10 cycles as
/// the kinetic COF" [Penner 1995, Experimental].
struct Method {
  std::string name = "penner-1995";
  int static_slip = 1;      ///< The slip whose peak is the static coefficient, from 1.
  int kinetic_cycles = 10;  ///< Cycles after the first peak that the kinetic coefficient averages, ≥ 1.
  std::optional<TravelWindow> kinetic_travel;  ///< If set, replaces kinetic_cycles.

  // Required test conditions; nullopt where the method leaves one open.
  std::optional<Nominal> sled_mass_kg;
  std::optional<double> sled_area_m2;
  std::optional<Nominal> pull_speed_m_per_s;
  std::optional<PullSpeed> speed_course;  ///< Planned speed of a ramp test; replaces pull_speed_m_per_s.
  std::optional<int> replicates;

  bool operator==(const Method&) const = default;
};

/// Departures of a test from its method in sled mass and pull speed, one line each, such as "pull speed 304.8
/// mm/min, iso-8295 asks 100 ± 10 mm/min"; empty if there are none. A quantity that the test does not know,
/// or for which the method has no value or no tolerance, is not compared.
/// \param sled_mass_kg,pull_speed_m_per_s  of the test; nullopt if unknown.
[[nodiscard]] std::vector<std::string> departures(const Method& method, std::optional<double> sled_mass_kg,
                                                  std::optional<double> pull_speed_m_per_s);

}  // namespace stickslip::model
