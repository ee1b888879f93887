#include "core/sim/rate_and_state_system.hpp"

#include <cmath>

#include "core/base/contract.hpp"

namespace stickslip::sim {
namespace {

/// ∂V/∂x of a contact so strong that x follows c within 1e-99 s anyway; keeps 1/(∂V/∂x) finite.
constexpr double kStiffest_m_per_s = 1e-100;

}  // namespace

RateAndStateSystem::RateAndStateSystem(const RateAndState& law, const model::Oscillator& oscillator,
                                       double gravity_m_per_s2)
    : law_(law),
      gamma_per_s_(oscillator.gamma_per_s),
      gravity_m_per_s2_(gravity_m_per_s2),
      per_metre_(oscillator.omega0_squared() / gravity_m_per_s2) {
  STICKSLIP_EXPECTS(law.a > 0.0 && law.b >= 0.0 && law.mu_0 >= 0.0);
  STICKSLIP_EXPECTS(law.critical_slip_m > 0.0 && law.reference_speed_m_per_s > 0.0);
}

RateAndStateSystem::Speed RateAndStateSystem::speed(double friction, double psi) const {
  const double strength = law_.mu_0 + law_.b * psi;
  const double forward = law_.reference_speed_m_per_s * std::exp((friction - strength) / law_.a);
  const double backward = law_.reference_speed_m_per_s * std::exp((-friction - strength) / law_.a);
  // The difference would cancel where x ≪ a.
  const double value =
      std::abs(friction) < law_.a
          ? 2.0 * law_.reference_speed_m_per_s * std::exp(-strength / law_.a) * std::sinh(friction / law_.a)
          : forward - backward;
  return {value, std::fmax((forward + backward) / law_.a, kStiffest_m_per_s)};
}

double RateAndStateSystem::speed_m_per_s(double friction, double psi) const {
  return speed(friction, psi).value;
}

double RateAndStateSystem::friction(double speed_m_per_s, double psi) const {
  if (speed_m_per_s == 0.0) return 0.0;
  // asinh z by ln 2z, where z itself might overflow.
  const double log_2z =
      std::log(std::abs(speed_m_per_s) / law_.reference_speed_m_per_s) + (law_.mu_0 + law_.b * psi) / law_.a;
  constexpr double kLarge = 20.0;  // asinh z − ln 2z = 1/4z² < 1e-16 beyond.
  const double magnitude = log_2z > kLarge ? log_2z : std::asinh(std::exp(log_2z) / 2.0);
  return std::copysign(law_.a * magnitude, speed_m_per_s);
}

RateAndStateSystem::Ageing RateAndStateSystem::ageing(const Speed& speed, double psi) const {
  const double magnitude = std::abs(speed.value);
  const double by_friction = std::copysign(speed.by_friction, speed.value);
  const double b_over_a = law_.b / law_.a;
  if (law_.law == RateAndState::Law::kAgeing) {
    const double healing = law_.reference_speed_m_per_s * std::exp(-psi);
    return {(healing - magnitude) / law_.critical_slip_m, -by_friction / law_.critical_slip_m,
            (b_over_a * magnitude - healing) / law_.critical_slip_m};
  }
  if (magnitude == 0.0) return {0.0, 0.0, 0.0};
  const double from_steady = psi + std::log(magnitude / law_.reference_speed_m_per_s);
  return {-magnitude * from_steady / law_.critical_slip_m,
          -by_friction * (from_steady + 1.0) / law_.critical_slip_m,
          magnitude * (b_over_a * (from_steady + 1.0) - 1.0) / law_.critical_slip_m};
}

double RateAndStateSystem::sliding_acceleration(double t_s, const OdeState& y, double speed_m_per_s) const {
  const double belt = piece_.belt.slope_at(t_s) / per_metre_;
  if (!piece_.taut) return belt - gravity_m_per_s2_ * y[1];
  const double stretching = piece_.belt.at(t_s) / per_metre_ - speed_m_per_s;
  return belt + gravity_m_per_s2_ * (y[0] - y[1]) + gamma_per_s_ * stretching;
}

OdeState RateAndStateSystem::rate(double t_s, const OdeState& y) const {
  const Speed now = speed(y[1], y[2]);
  const double psi_rate = ageing(now, y[2]).rate;
  return {piece_.belt.at(t_s) - per_metre_ * now.value,
          sliding_acceleration(t_s, y, now.value) / now.by_friction +
              law_.b * std::tanh(y[1] / law_.a) * psi_rate,
          psi_rate};
}

double RateAndStateSystem::acceleration(double t_s, const OdeState& y) const {
  const double speed = speed_m_per_s(y[1], y[2]);
  return piece_.belt.slope_at(t_s) - per_metre_ * sliding_acceleration(t_s, y, speed);
}

OdeSystem::Jacobian RateAndStateSystem::jacobian(double t_s, const OdeState& y) const {
  const Speed now = speed(y[1], y[2]);
  const Ageing age = ageing(now, y[2]);
  const double tanh = std::tanh(y[1] / law_.a);
  const double by_psi = -law_.b / law_.a * now.value;
  const double gamma = piece_.taut ? gamma_per_s_ : 0.0;
  const double pace = sliding_acceleration(t_s, y, now.value) / now.by_friction;
  Jacobian jacobian{};
  jacobian[0] = {0.0, -per_metre_ * now.by_friction, -per_metre_ * by_psi};
  jacobian[1][0] = piece_.taut ? gravity_m_per_s2_ / now.by_friction : 0.0;
  jacobian[1][1] = -gravity_m_per_s2_ / now.by_friction - gamma - pace * tanh / law_.a +
                   law_.b * (age.rate * (1.0 - tanh * tanh) / law_.a + tanh * age.by_friction);
  jacobian[1][2] = -gamma * by_psi / now.by_friction + law_.b / law_.a * pace + law_.b * tanh * age.by_psi;
  jacobian[2] = {0.0, age.by_friction, age.by_psi};
  return jacobian;
}

OdeSystem::Events RateAndStateSystem::events(double t_s, const OdeState& y) const {
  const double speed = speed_m_per_s(y[1], y[2]);
  Events events;
  if (piece_.watches_force) {
    const double c_rate = piece_.belt.at(t_s) - per_metre_ * speed;
    events[kNoForce] = piece_.taut ? Event{-y[0], -c_rate} : Event{y[0], c_rate};
  }
  // Thresholds of a name, not of the motion: where they are only touched nothing is missed.
  if (piece_.fast_m_per_s > 0.0) events[kFast] = {std::abs(speed) / piece_.fast_m_per_s - 1.0, 0.0};
  if (piece_.caught_up_m_per_s > 0.0) {
    events[kCaughtUp] = {1.0 - std::abs(speed) / piece_.caught_up_m_per_s, 0.0};
  }
  return events;
}

}  // namespace stickslip::sim
