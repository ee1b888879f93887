#include "core/model/slip_waveform.hpp"

#include <cmath>
#include <numbers>

namespace stickslip::model {

using std::numbers::pi;

double SlipWaveform::value(double t_s) const noexcept {
  const DampedBasis at = damped_basis(oscillator, t_s);
  return K + (D * at.cosine + (r + oscillator.gamma_per_s * D / 2.0) * at.sine);
}

double SlipWaveform::rate(double t_s) const noexcept { return rate(damped_basis(oscillator, t_s)); }

double SlipWaveform::acceleration(double t_s) const noexcept { return motion(t_s).acceleration; }

SlipWaveform::Motion SlipWaveform::motion(double t_s) const noexcept {
  const DampedBasis at = damped_basis(oscillator, t_s);
  const double gamma = oscillator.gamma_per_s;
  const double omega0_squared = oscillator.omega0_squared();
  const double start = -gamma * r - omega0_squared * D;
  // c″ is a solution of the same oscillator: from start, with the slope −γ c″ − ω₀² c′.
  return {rate(at), start * at.cosine - (gamma * start / 2.0 + omega0_squared * r) * at.sine};
}

double SlipWaveform::peak_time_s() const noexcept {
  const double omega = oscillator.omega_rad_per_s();
  return std::atan2(omega * r, oscillator.omega0_squared() * D + oscillator.gamma_per_s * r / 2.0) / omega;
}

double SlipWaveform::fastest_slip_time_s() const noexcept {
  return peak_time_s() + (pi / 2.0 - oscillator.phi_rad()) / oscillator.omega_rad_per_s();
}

double SlipWaveform::rise_end_time_s() const noexcept {
  return fastest_slip_time_s() + pi / oscillator.omega_rad_per_s();
}

double SlipWaveform::trough_time_s() const noexcept {
  return peak_time_s() + pi / oscillator.omega_rad_per_s();
}

}  // namespace stickslip::model
