/// \file
/// From what a steady stick-slip oscillation shows back to the dimensionless speed Q, and so to
/// S − K = r/(ω Q): by its amplitude [Penner 1995, (17)], by its period, and by its fastest slip [(18)], each
/// with the condition number that says how much of its relative error S − K gets.
///
///     if (const auto speed = Q_of_slip_speed_ratio(1.2, 0.022)) use(r / (omega * speed->Q));
#pragma once

#include <optional>

namespace stickslip::model {

struct InvertedSpeed {
  double Q = 0.0;
  /// |d ln Q/d ln x| of the number given; for [17] and [18] about 1 + Q², so above 4 near the threshold.
  double condition = 0.0;
};

// γ/2ω: from 0 to 1; nothing outside, and nothing where no Q in (1e-6, 1e6) gives the number.

/// \param amplitude_over_belt  A ω/r: half the range of c over r/ω. Falls as Q grows, [17]/Q.
[[nodiscard]] std::optional<InvertedSpeed> Q_of_amplitude(double amplitude_over_belt,
                                                          double gamma_over_2omega) noexcept;
/// \param ratio  largest slip speed over drive speed [18]; falls towards a limit below 1 as Q grows, so that
///               ratios near 1 say little: the condition number grows as 1/(1 − ratio) there.
[[nodiscard]] std::optional<InvertedSpeed> Q_of_slip_speed_ratio(double ratio,
                                                                 double gamma_over_2omega) noexcept;
/// \param period_phase_rad  ω T of a cycle that sticks; falls as Q grows to the threshold.
[[nodiscard]] std::optional<InvertedSpeed> Q_of_period(double period_phase_rad,
                                                       double gamma_over_2omega) noexcept;

/// ω T from onset to onset; nothing above the threshold. Without damping [3] + [4]. \param Q > 0, finite.
[[nodiscard]] std::optional<double> period_phase_rad(double Q, double gamma_over_2omega) noexcept;

/// (mean of c over a cycle − K)/(S − K): what damping adds to the traditional kinetic coefficient. 0 without
/// damping [1]; nothing above the threshold. \param Q > 0, finite.
[[nodiscard]] std::optional<double> cycle_mean_excess(double Q, double gamma_over_2omega) noexcept;

}  // namespace stickslip::model
