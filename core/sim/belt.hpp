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

/// Speed of a segment, m/s, as a function of the time in s after its start; its duration is ignored. At 0 it
/// is exactly speed + decaying_speed, thus 0 for a motor that starts from rest.
[[nodiscard]] ExponentialPolynomial belt_speed(const BeltSegment& segment);

/// Belt speed, m/s, at this time ≥ 0 after scan 0: at the border of two segments that of the later, after the
/// last segment 0. Ignores halt_when_unloaded.
[[nodiscard]] double belt_speed_m_per_s(const std::vector<BeltSegment>& belt, double time_s);

/// Smallest (≤ 0) and largest (≥ 0) net travel ∫v dt of the belt, m, from scan 0 to any time up to
/// duration_s. Ignores halt_when_unloaded: the true range lies within this one as long as nothing moves after
/// a segment that halts, as in all scenes; a later pull may exceed it.
/// \param belt  without a segment that has both jerk and a decaying speed.
/// \param duration_s  finite.
[[nodiscard]] std::pair<double, double> belt_travel_range_m(const std::vector<BeltSegment>& belt,
                                                            double duration_s);

/// Factor f(x) of K. \param x  time since scan 0, s, or net belt travel since then, m, as drift.over says.
[[nodiscard]] double drift_factor(const KineticDrift& drift, double x);

}  // namespace stickslip::sim
