#include "core/model/oscillator.hpp"

#include <cmath>

namespace stickslip::model {
namespace {

/// Below this |ω²t²| the Taylor series replaces sin u/u: seven terms leave z⁷/15! < 1e-26.
constexpr double kSeriesLimit = 1e-2;

/// Σ (−z)ⁿ/(2n)!
double cosine_series(double z) noexcept {
  double sum = 1.0;
  for (int n = 6; n >= 1; --n) sum = 1.0 - z / ((2.0 * n - 1.0) * (2.0 * n)) * sum;
  return sum;
}

/// Σ (−z)ⁿ/(2n+1)!
double sine_series(double z) noexcept {
  double sum = 1.0;
  for (int n = 6; n >= 1; --n) sum = 1.0 - z / ((2.0 * n) * (2.0 * n + 1.0)) * sum;
  return sum;
}

}  // namespace

double entire_cosine(double omega_squared, double t_s) noexcept {
  const double z = omega_squared * t_s * t_s;
  if (std::abs(z) < kSeriesLimit) return cosine_series(z);
  const double frequency = std::sqrt(std::abs(omega_squared));
  return z > 0.0 ? std::cos(frequency * t_s) : std::cosh(frequency * t_s);
}

double entire_sine(double omega_squared, double t_s) noexcept {
  const double z = omega_squared * t_s * t_s;
  if (std::abs(z) < kSeriesLimit) return t_s * sine_series(z);
  const double frequency = std::sqrt(std::abs(omega_squared));
  return (z > 0.0 ? std::sin(frequency * t_s) : std::sinh(frequency * t_s)) / frequency;
}

Oscillator Oscillator::from_omega(double omega_rad_per_s, double gamma_over_2omega) noexcept {
  return {2.0 * omega_rad_per_s * gamma_over_2omega, omega_rad_per_s * omega_rad_per_s};
}

Oscillator Oscillator::from_omega0(double omega0_squared, double gamma_per_s) noexcept {
  return {gamma_per_s, omega0_squared - gamma_per_s * gamma_per_s / 4.0};
}

double Oscillator::omega_rad_per_s() const noexcept { return std::sqrt(omega_squared); }

double Oscillator::gamma_over_2omega() const noexcept { return gamma_per_s / (2.0 * omega_rad_per_s()); }

double Oscillator::phi_rad() const noexcept { return std::atan(gamma_over_2omega()); }

DampedBasis damped_basis(const Oscillator& oscillator, double t_s) noexcept {
  const double z = oscillator.omega_squared * t_s * t_s;
  if (z >= kSeriesLimit) {  // As below, with what the two share worked out once.
    const double omega = std::sqrt(oscillator.omega_squared);
    const double decay = std::exp(-oscillator.gamma_per_s * t_s / 2.0);
    return {decay * std::cos(omega * t_s), decay * (std::sin(omega * t_s) / omega)};
  }
  if (z > -kSeriesLimit) {
    const double decay = std::exp(-oscillator.gamma_per_s * t_s / 2.0);
    return {decay * entire_cosine(oscillator.omega_squared, t_s),
            decay * entire_sine(oscillator.omega_squared, t_s)};
  }
  // Overdamped: γ/2 − κ cancels, but it equals ω₀²/(γ/2 + κ).
  const double kappa = std::sqrt(-oscillator.omega_squared);
  const double slow_rate = oscillator.omega0_squared() / (oscillator.gamma_per_s / 2.0 + kappa);
  const double slow = std::exp(-slow_rate * t_s);
  const double difference = std::expm1(-2.0 * kappa * t_s);
  return {slow * (2.0 + difference) / 2.0, slow * -difference / (2.0 * kappa)};
}

}  // namespace stickslip::model
