/// \file
/// Closed forms of whole cycles, as functions of the dimensionless speed Q and γ/2ω.
/// φ = atan(γ/2ω) [10]. Equation numbers: Penner 1995.
#pragma once

namespace stickslip::model {

/// ω t₁ = θ − φ [9], [10], [15], rad: phase from the onset of a slip to the peak of the force, in
/// [0, π/2 − φ]; 0 for Q = 0.
/// \param Q ≥ 0, infinity allowed.
/// \param gamma_over_2omega ≥ 0, finite.
[[nodiscard]] double peak_phase_rad(double Q, double gamma_over_2omega) noexcept;
/// θ = atan(Q + γ/2ω) [9], rad. Domain as peak_phase_rad().
[[nodiscard]] double theta_rad(double Q, double gamma_over_2omega) noexcept;

/// Dimensionless speed Q = r/(ω (S − K)) [8].
/// \param stick_rate_per_s r = ω₀² v/g ≥ 0.
/// \param omega_rad_per_s damped, > 0.
/// \param delta_mu S − K ≥ 0.
/// \return infinity if S − K is 0 and r is not; NaN if both are 0.
[[nodiscard]] double dimensionless_speed(double stick_rate_per_s, double omega_rad_per_s,
                                         double delta_mu) noexcept;

/// [2]: K + (S − K) √(1 + Q²), the largest coefficient without damping.
[[nodiscard]] double undamped_maximum(double mu_k, double delta_mu, double Q) noexcept;
/// [3]: ω t_stick without damping = 2/Q, rad. \param Q > 0.
[[nodiscard]] double undamped_stick_phase_rad(double Q) noexcept;
/// [4]: ω t_slip without damping = 2π − 2 atan(1/Q), rad. \param Q > 0.
[[nodiscard]] double undamped_slip_phase_rad(double Q) noexcept;

/// [17]: half the range of c in one slip, from peak to trough, over S − K; √(1 + Q²) without damping.
/// \param Q ≥ 0, finite.
[[nodiscard]] double amplitude_ratio(double Q, double gamma_over_2omega) noexcept;
/// [18]: largest slip speed over drive speed, which is −c′(t₂)/r; infinity for Q = 0. \param Q ≥ 0.
[[nodiscard]] double slip_speed_ratio(double Q, double gamma_over_2omega) noexcept;

/// e^(πε), ε = γ/2ω: the smallest slip_speed_ratio() ρ of a slip that ends in sticking. The extremes of c′ of
/// a free oscillation follow each other by π/ω, each smaller than the last by e^(−πε) [16], [20]. So c′ rises
/// from −ρ r at t₂ to ρ r e^(−πε) at t₃, and the sled is captured exactly where that is ≥ r [20], [21]. The
/// ratio alone tells the regime, whatever S − K, speed and calibration are.
/// \param gamma_over_2omega ≥ 0.
[[nodiscard]] double slip_speed_ratio_threshold(double gamma_over_2omega) noexcept;

/// γ/2ω = ln 2/(2π n) of an oscillation whose amplitude halves in n cycles. \param cycles > 0.
[[nodiscard]] double gamma_over_2omega_of_half_life(double cycles) noexcept;

}  // namespace stickslip::model
