/// \file
/// First time at which a damped oscillation, alone or added to an ExponentialPolynomial, rises to a level.
/// All events are of this kind: capture (the rate of the force reaches that of the belt), slack (the negative
/// force reaches zero), and, without an oscillation, slip onset and a coupling that becomes taut.
#pragma once

#include <optional>

#include "core/model/slip_waveform.hpp"
#include "core/sim/exponential_polynomial.hpp"

namespace stickslip::sim {

/// Whether a maximum exactly at the level is an event.
enum class Touch { kCounts, kDoesNot };

/// First t ≥ 0 at which y(t) rises through `level`, given y(0) ≤ level; nullopt if it never does. 0 only if
/// y(0) = level, to rounding, and y leaves it upwards at once.
///
/// y is monotone between its extremes, which are known in closed form. Its first maximum is the largest. So
/// the sign of y − level there decides whether the event exists; only then its time is bracketed and refined.
/// No event is missed, grazing included.
///
/// \param y  homogeneous: y.K = 0.
[[nodiscard]] std::optional<double> first_rise_s(const model::SlipWaveform& y, double level, Touch touch);

/// Sum of an oscillation and an ExponentialPolynomial.
struct Curve {
  model::SlipWaveform wave;  ///< Homogeneous: wave.K = 0; wave.D = wave.r = 0 where nothing oscillates.
  ExponentialPolynomial course;

  [[nodiscard]] bool oscillates() const noexcept { return wave.D != 0.0 || wave.r != 0.0; }
  [[nodiscard]] double value(double t_s) const noexcept {
    return (oscillates() ? wave.value(t_s) : 0.0) + course.value(t_s);
  }
};

/// First t in [from, end] at which y(t) rises through zero; nullopt if there is none. A value at `from`
/// within rounding of zero counts as below, so that the result is `from` where y leaves zero upwards at once.
/// If y(from) is above zero, y has to fall to zero first. end_s may be very long, but finite.
///
/// Method: Rolle's theorem. d/dt lowers the polynomial by a degree, d/dt + λ removes a decay, until only the
/// oscillation (or a constant) is left, whose zeros are known in closed form. Between two neighbouring zeros
/// of such a derivative the function that it came from is monotone (after multiplication with e^(λt)), so
/// that its signs there bracket all of its zeros, and none is stepped over. While the envelope of the
/// oscillation stays below zero, the search skips ahead.
[[nodiscard]] std::optional<double> first_rise_s(const Curve& y, double from_s, double end_s, Touch touch);

}  // namespace stickslip::sim
