/// \file
/// Speed and travel of a motion's belt as functions of time.
///
///     belt_speed(segment).value(t);            // m/s, t after the start of the segment
///     belt_speed_m_per_s(motion.belt, 2.0);    // at 2 s of the scene
#pragma once

#include <utility>
#include <vector>

#include "core/sim/exponential_polynomial.hpp"
#include "core/sim/motion.hpp"

namespace stickslip::sim {

/// v(t) of a segment, m/s. Starts at exactly speed + decaying_speed.
[[nodiscard]] ExponentialPolynomial belt_speed(const BeltSegment& segment);

/// Belt speed at a time ≥ 0 of the scene; at the border of two segments, that of the later. Ignores
/// halt_when_unloaded.
[[nodiscard]] double belt_speed_m_per_s(const std::vector<BeltSegment>& belt, double time_s);

/// Smallest and largest travel ∫v dt of the belt within this time, m: (≤ 0, ≥ 0). Ignores halt_when_unloaded,
/// so the true range may be narrower.
[[nodiscard]] std::pair<double, double> belt_travel_range_m(const std::vector<BeltSegment>& belt,
                                                            double duration_s);

/// f(x) of a drift, x in s or m.
[[nodiscard]] double drift_factor(const KineticDrift& drift, double x);

}  // namespace stickslip::sim
