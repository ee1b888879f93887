#include "core/sim/sliding_system.hpp"

#include <cmath>

namespace stickslip::sim {
namespace {

struct Weakening {
  double value;
  double slope;
};

/// e^(−x^δ) for x ≥ 0. CVODE tries steps that end a little below zero, where friction has no such sign:
/// there the curve goes on as smoothly as it can, even or odd in x as δ is, and no higher than e.
Weakening weakening(double x, double exponent) {
  const double magnitude = std::abs(x);
  if (magnitude == 0.0) return {1.0, exponent == 1.0 ? -1.0 : 0.0};
  const bool odd = std::lround(exponent) % 2 != 0;
  const double sign = x < 0.0 && odd ? -1.0 : 1.0;
  const double power = std::pow(magnitude, exponent);
  if (sign * power < -1.0) return {std::exp(1.0), 0.0};
  const double value = std::exp(-sign * power);
  const double slope = -sign * exponent * power / magnitude * value * (x < 0.0 ? -1.0 : 1.0);
  return {value, slope};
}

}  // namespace

SlidingSystem::SlidingSystem(const model::Oscillator& oscillator, double gravity_m_per_s2,
                             const std::optional<VelocityDependence>& law)
    : gamma_per_s_(oscillator.gamma_per_s),
      omega0_rad_per_s_(std::sqrt(oscillator.omega0_squared())),
      metres_(gravity_m_per_s2 / oscillator.omega0_squared()),
      law_(law) {}

SlidingSystem::Friction SlidingSystem::friction(double t_s, double c_rate) const {
  Friction friction{piece_.mu_k * piece_.drift.factor(t_s), 0.0};
  if (!law_) return friction;
  const double speed_m_per_s = piece_.sign * (piece_.belt.at(t_s) - c_rate) * metres_;
  const double scale = law_->stribeck_speed_m_per_s;
  const Weakening stribeck = weakening(speed_m_per_s / scale, law_->stribeck_exponent);
  friction.value += law_->per_speed_s_per_m * speed_m_per_s + piece_.stribeck_rise * stribeck.value;
  friction.slope = metres_ * (law_->per_speed_s_per_m + piece_.stribeck_rise * stribeck.slope / scale);
  return friction;
}

double SlidingSystem::acceleration(double t_s, const OdeState& y) const {
  const double omega0_squared = omega0_rad_per_s_ * omega0_rad_per_s_;
  const double c_rate = omega0_rad_per_s_ * y[1];
  const double pull = piece_.sign * friction(t_s, c_rate).value;
  return piece_.taut ? omega0_squared * (pull - y[0]) - gamma_per_s_ * c_rate : omega0_squared * pull;
}

OdeState SlidingSystem::rate(double t_s, const OdeState& y) const {
  return {omega0_rad_per_s_ * y[1], acceleration(t_s, y) / omega0_rad_per_s_};
}

OdeSystem::Jacobian SlidingSystem::jacobian(double t_s, const OdeState& y) const {
  // σ K depends on c′ through V = σ (r − c′): the two signs cancel.
  const double by_rate =
      -omega0_rad_per_s_ * omega0_rad_per_s_ * friction(t_s, omega0_rad_per_s_ * y[1]).slope;
  Jacobian jacobian{};
  jacobian[0][1] = omega0_rad_per_s_;
  jacobian[1][0] = piece_.taut ? -omega0_rad_per_s_ : 0.0;
  jacobian[1][1] = by_rate - (piece_.taut ? gamma_per_s_ : 0.0);
  return jacobian;
}

double SlidingSystem::slid(double t_s, double c) const {
  return piece_.sign * (piece_.belt.travel(t_s) - (c - piece_.begun_c));
}

OdeSystem::Events SlidingSystem::events(double t_s, const OdeState& y) const {
  const double c_rate = omega0_rad_per_s_ * y[1];
  const double sliding = piece_.sign * (c_rate - piece_.belt.at(t_s));
  Events events;
  events[kBeltSpeed] = {sliding, piece_.sign * (acceleration(t_s, y) - piece_.belt.slope_at(t_s)),
                        doubt_per_s_};
  if (piece_.watches_force) {
    events[kNoForce] = piece_.taut ? Event{-y[0], -c_rate} : Event{y[0], c_rate};
  }
  if (std::isfinite(piece_.place_left)) {
    events[kNewPlace] = {slid(t_s, y[0]) - piece_.place_left, -sliding};
  }
  return events;
}

}  // namespace stickslip::sim
