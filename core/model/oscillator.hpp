/// \file
/// The sled on its coupling, as a damped oscillator: x″ + γ x′ + ω₀² x = 0. [Penner 1995, (6), (7)]
///
///     const Oscillator tester = Oscillator::from_omega(2.0 * std::numbers::pi * 20.0, 0.022);
///     const DampedBasis at = damped_basis(tester, 0.010);
///     const double x = x0 * at.cosine + (v0 + tester.gamma_per_s / 2.0 * x0) * at.sine;
///
/// cos ωt and sin(ωt)/ω are entire functions of ω², so that one code path leads through under-,
/// critically and over-damped motion (ω² > 0, = 0, < 0) without a jump.
#pragma once

namespace stickslip::model {

/// C(ω², t) = cos ωt, cosh κt for ω² = −κ² < 0.
/// \param omega_squared  rad²/s², any sign, finite.
/// \param t_s            finite; for ω² < 0 the result overflows to infinity past |κt| ≈ 710.
[[nodiscard]] double entire_cosine(double omega_squared, double t_s) noexcept;

/// Sn(ω², t) = sin(ωt)/ω in seconds, sinh(κt)/κ for ω² = −κ² < 0, t for ω² = 0. Domain as entire_cosine().
[[nodiscard]] double entire_sine(double omega_squared, double t_s) noexcept;

/// Oscillator of sled and coupling; its parameters belong to the tester, not to the paper.
struct Oscillator {
  double gamma_per_s = 0.0;  ///< γ ≥ 0; a fit may reach below 0.
  double omega_squared = 0.0;  ///< ω² = ω₀² − γ²/4 [7], rad²/s²; ≤ 0 if the motion does not oscillate.

  /// From the frequency and decay of a free oscillation.
  /// \param omega_rad_per_s > 0, damped.
  /// \param gamma_over_2omega ≥ 0.
  [[nodiscard]] static Oscillator from_omega(double omega_rad_per_s, double gamma_over_2omega) noexcept;
  /// From stiffness, mass and damping of the coupling.
  /// \param omega0_squared = k/m > 0.
  /// \param gamma_per_s ≥ 0, may overdamp.
  [[nodiscard]] static Oscillator from_omega0(double omega0_squared, double gamma_per_s) noexcept;

  [[nodiscard]] double omega0_squared() const noexcept {
    return omega_squared + gamma_per_s * gamma_per_s / 4.0;
  }
  [[nodiscard]] bool oscillates() const noexcept { return omega_squared > 0.0; }
  /// ω; only if oscillates().
  [[nodiscard]] double omega_rad_per_s() const noexcept;
  /// γ/2ω = tan φ; only if oscillates().
  [[nodiscard]] double gamma_over_2omega() const noexcept;
  /// φ [10], rad; only if oscillates().
  [[nodiscard]] double phi_rad() const noexcept;
  /// r = ω₀² v/g: rate of the coefficient while the sled sticks, 1/s.
  [[nodiscard]] double stick_rate_per_s(double speed_m_per_s, double gravity_m_per_s2) const noexcept {
    return omega0_squared() * speed_m_per_s / gravity_m_per_s2;
  }
};

/// The two solutions of the oscillator with initial value and rate (1, −γ/2) and (0, 1).
struct DampedBasis {
  double cosine;  ///< e^(−γt/2) C(ω², t)
  double sine;    ///< e^(−γt/2) Sn(ω², t), s
};

/// The basis at t_s. For t_s ≥ 0 and γ ≥ 0 it does not overflow, however strong the damping.
/// \param t_s  ≥ 0; also negative if the oscillator oscillates.
[[nodiscard]] DampedBasis damped_basis(const Oscillator& oscillator, double t_s) noexcept;

}  // namespace stickslip::model
