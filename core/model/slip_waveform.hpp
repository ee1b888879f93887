/// \file
/// The force during one slip in closed form. [Penner 1995, (11)–(16), (20)]
///
///     const SlipWaveform slip{0.30, 0.05, r, Oscillator::from_omega(omega, 0.022)};
///     const double peak = slip.value(slip.peak_time_s());
///
/// Written so that nothing divides by D or cos θ: it holds for D → 0, Q → ∞ and r → 0, and for
/// any state at the start, not only the paper's c = S, c′ = r.
#pragma once

#include "core/model/oscillator.hpp"

namespace stickslip::model {

/// The coefficient during one slip: the solution of c″ + γ c′ + ω₀² (c − K) = 0 from c(0) = K + D, c′(0) = r.
/// Times are seconds after the onset, ≥ 0.
struct SlipWaveform {
  double K = 0.0;  ///< Kinetic coefficient.
  double D = 0.0;  ///< c(0) − K; S − K if the slip starts from sticking [13].
  double r = 0.0;  ///< c′(0), 1/s; ω₀² v/g if the slip starts from sticking [14].
  Oscillator oscillator;

  /// c(t) [11].
  [[nodiscard]] double value(double t_s) const noexcept;
  /// c′(t) [12], 1/s.
  [[nodiscard]] double rate(double t_s) const noexcept;
  /// c′(t) from damped_basis(oscillator, t), 1/s.
  [[nodiscard]] double rate(const DampedBasis& at) const noexcept {
    return r * at.cosine - (oscillator.gamma_per_s * r / 2.0 + oscillator.omega0_squared() * D) * at.sine;
  }
  /// c″(t), 1/s².
  [[nodiscard]] double acceleration(double t_s) const noexcept;
  struct Motion {
    double rate;
    double acceleration;
  };
  /// c′ and c″ from one evaluation of the basis.
  [[nodiscard]] Motion motion(double t_s) const noexcept;

  // The following require oscillator.oscillates().

  /// t₁ [15]: maximum of the force. In (−π/ω, π/ω]; negative if it lies before the start.
  [[nodiscard]] double peak_time_s() const noexcept;
  /// t₂ = t₁ + (π/2 − φ)/ω [16]: fastest slip, least c′.
  [[nodiscard]] double fastest_slip_time_s() const noexcept;
  /// t₃ = t₂ + π/ω [20]: end of the rise of c′. On a belt of constant speed capture happens in [t₂, t₃] or
  /// not at all; it happens exactly when rate(t₃) ≥ the rate of the belt.
  [[nodiscard]] double rise_end_time_s() const noexcept;
  /// t₁ + π/ω: minimum of the force. Capture by a belt that moves forward comes later.
  [[nodiscard]] double trough_time_s() const noexcept;
};

}  // namespace stickslip::model
