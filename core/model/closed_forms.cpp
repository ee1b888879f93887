#include "core/model/closed_forms.hpp"

#include <cmath>
#include <numbers>

namespace stickslip::model {

using std::numbers::pi;

double peak_phase_rad(double Q, double gamma_over_2omega) noexcept {
  // tan(θ − φ) written out: the difference of two nearly equal angles is never formed.
  if (std::isinf(Q)) return std::atan2(1.0, gamma_over_2omega);
  return std::atan2(Q, 1.0 + gamma_over_2omega * (Q + gamma_over_2omega));
}

double theta_rad(double Q, double gamma_over_2omega) noexcept { return std::atan(Q + gamma_over_2omega); }

double dimensionless_speed(double stick_rate_per_s, double omega_rad_per_s, double delta_mu) noexcept {
  return stick_rate_per_s / (omega_rad_per_s * delta_mu);
}

double undamped_maximum(double mu_k, double delta_mu, double Q) noexcept {
  return mu_k + delta_mu * std::hypot(1.0, Q);
}

double undamped_stick_phase_rad(double Q) noexcept { return 2.0 / Q; }

double undamped_slip_phase_rad(double Q) noexcept { return 2.0 * pi - 2.0 * std::atan(1.0 / Q); }

double amplitude_ratio(double Q, double gamma_over_2omega) noexcept {
  const double t = gamma_over_2omega;
  const double decay_to_peak = std::exp(-t * peak_phase_rad(Q, t));
  const double cos_phi_over_cos_theta = std::hypot(1.0, Q + t) / std::hypot(1.0, t);
  return decay_to_peak * (1.0 + std::exp(-pi * t)) * cos_phi_over_cos_theta / 2.0;
}

double slip_speed_ratio(double Q, double gamma_over_2omega) noexcept {
  const double t = gamma_over_2omega;
  const double peak_phase = peak_phase_rad(Q, t);
  const double fastest_phase = peak_phase + std::atan2(1.0, t);  // [16]: π/2 − φ later.
  return std::exp(-t * fastest_phase) / (std::hypot(1.0, t) * std::sin(peak_phase));
}

double slip_speed_ratio_threshold(double gamma_over_2omega) noexcept {
  return std::exp(std::numbers::pi * gamma_over_2omega);
}

double gamma_over_2omega_of_half_life(double cycles) noexcept {
  return std::numbers::ln2 / (2.0 * pi * cycles);
}

}  // namespace stickslip::model
