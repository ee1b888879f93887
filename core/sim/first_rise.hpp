/// \file
/// Where a damped oscillation first rises to a level: the one event of a slip. Capture is the rate
/// of the force reaching the rate of the belt; slack is the (negative) force reaching zero.
#pragma once

#include <optional>

#include "core/friction/slip_waveform.hpp"

namespace stickslip::sim {

enum class Touch { kCounts, kDoesNot };

/// First t > 0 at which y(t) rises through `level`, given y(0) ≤ level.
///
/// Between its extremes, which are known in closed form, y is monotone. Its first maximum is the
/// highest that it will ever reach above zero, so the sign of y there minus the level decides
/// whether the event exists; only then its time is bracketed and refined [Algorithm 748: Alefeld,
/// Potra and Shi, ACM TOMS 21(3):327–344, 1995]. Nothing is stepped over, grazing included.
///
/// \param y      homogeneous: y.K = 0.
/// \param touch  whether a maximum exactly at the level is an event.
[[nodiscard]] std::optional<double> first_rise_s(const friction::SlipWaveform& y, double level, Touch touch);

}  // namespace stickslip::sim
