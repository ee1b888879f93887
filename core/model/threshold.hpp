/// \file
/// Threshold speed: above it the sled does not stick again and the oscillation decays. [Penner 1995, (22)]
///
///     const double Q_th = Q_threshold(0.022);                     // 1.93871744784
///     const double v_th = threshold_speed_m_per_s(oscillator, 0.05, kStandardGravity_m_per_s2);
///
/// With x = θ − φ: tan φ · (x − φ + 3π/2) = ln(cos φ/sin x). The difference of both sides is monotone and
/// changes its sign once, between bounds known in advance. Algorithm 748 [Alefeld, Potra and Shi, ACM TOMS
/// 21(3):327–344, 1995] finds the root and cannot fail.
#pragma once

#include "core/model/oscillator.hpp"

namespace stickslip::model {

/// Largest accepted γ/2ω; Q_th is 1e-135 there.
inline constexpr double kLargestGammaOver2Omega = 100.0;

/// Q_th [22].
/// \param gamma_over_2omega  0 … kLargestGammaOver2Omega.
/// \return infinity for 0 (without damping the sled always sticks again); NaN outside the domain.
[[nodiscard]] double Q_threshold(double gamma_over_2omega) noexcept;

/// θ at the threshold [9], rad; π/2 without damping. Domain as Q_threshold().
[[nodiscard]] double theta_threshold_rad(double gamma_over_2omega) noexcept;

/// Threshold speed v_th = Q_th ω g (S − K)/ω₀², m/s.
/// \param oscillator  underdamped.
/// \param delta_mu  S − K ≥ 0.
/// \param gravity_m_per_s2 > 0.
/// \return infinity without damping, but NaN if S − K is 0, too; NaN if γ/2ω is outside the domain of
/// Q_threshold().
[[nodiscard]] double threshold_speed_m_per_s(const Oscillator& oscillator, double delta_mu,
                                             double gravity_m_per_s2) noexcept;

/// S − K from a measured threshold speed: inverse of threshold_speed_m_per_s(). 0 without damping; NaN if
/// γ/2ω is outside the domain of Q_threshold().
[[nodiscard]] double delta_mu_of_threshold_speed(const Oscillator& oscillator, double threshold_speed_m_per_s,
                                                 double gravity_m_per_s2) noexcept;

}  // namespace stickslip::model
