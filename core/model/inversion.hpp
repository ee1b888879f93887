/// \file
/// Inverse closed forms: the dimensionless speed Q, and so S − K = r/(ω Q), from features of a steady
/// stick-slip oscillation: its amplitude [Penner 1995, (17)], its period, its fastest slip [(18)]. Each comes
/// with the condition number by which a relative error of the feature appears in S − K.
///
///     if (const auto speed = Q_of_slip_speed_ratio(1.2, 0.022)) use(r / (omega * speed->Q));
#pragma once

#include <optional>

namespace stickslip::model {

struct InvertedSpeed {
  double Q = 0.0;
  /// |d ln Q/d ln x| for the feature x. For [17] and [18] it is 1 + Q² without damping and less with it; 4.5
  /// at the threshold of the paper's tester.
  double condition = 0.0;
};

// Domain: γ/2ω from 0 to 1. The inverses return nullopt outside, and if no Q in (1e-6, 1e6) has the feature's
// value. `near` is the result for a nearby value. It saves two thirds of the time; the answer may then have
// the condition number of `near`.

/// Q from the amplitude [17].
/// \param amplitude_over_belt  A ω/r: half the range of c over r/ω, equal to amplitude_ratio()/Q. Decreases
/// as Q grows.
[[nodiscard]] std::optional<InvertedSpeed> Q_of_amplitude(
    double amplitude_over_belt, double gamma_over_2omega,
    const std::optional<InvertedSpeed>& near = {}) noexcept;
/// Q from the slip speed [18].
/// \param ratio  largest slip speed over drive speed. Decreases as Q grows, towards e^(−(π − 2φ) γ/2ω) ≤ 1
/// with φ = atan(γ/2ω). Near this limit it hardly determines Q: the condition number grows
/// as 1/(ratio − limit).
[[nodiscard]] std::optional<InvertedSpeed> Q_of_slip_speed_ratio(
    double ratio, double gamma_over_2omega, const std::optional<InvertedSpeed>& near = {}) noexcept;
/// Q, below the threshold, from the period.
/// \param period_phase_rad  ω T of a cycle that ends in sticking; decreases as Q grows.
[[nodiscard]] std::optional<InvertedSpeed> Q_of_period(double period_phase_rad,
                                                       double gamma_over_2omega) noexcept;

/// Period from onset to onset as a phase, ω T, rad; without damping [3] + [4]. Nullopt above the threshold.
/// \param Q > 0, finite.
[[nodiscard]] std::optional<double> period_phase_rad(double Q, double gamma_over_2omega) noexcept;

/// (mean of c over a cycle − K)/(S − K): the bias of the traditional kinetic coefficient by damping. 0
/// without damping [1]; nullopt above the threshold.
/// \param Q > 0, finite.
[[nodiscard]] std::optional<double> cycle_mean_excess(double Q, double gamma_over_2omega) noexcept;

}  // namespace stickslip::model
