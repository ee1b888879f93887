#include "core/accuracy/oscillation50.hpp"

#include <cstdint>

#include <boost/math/tools/toms748_solve.hpp>

namespace stickslip::accuracy {
namespace {

/// Bits to which roots are refined; the other digits of a Real are lost to rounding in the function.
constexpr int kRootBits = 155;  // 46 digits.

/// \param low,high  y goes from below the level to at least the level without turning back.
Real root_between(const Oscillation50& y, const Real& level, const Real& low, const Real& high) {
  const auto excess = [&](const Real& t) -> Real { return y.value(t) - level; };
  const Real at_low = excess(low);
  const Real at_high = excess(high);
  if (at_low >= 0) return low;
  if (at_high <= 0) return high;
  const auto close_enough = [](const Real& a, const Real& b) {
    return abs(Real(b - a)) <= ldexp(abs(a), -kRootBits);
  };
  std::uintmax_t iterations = 1000;
  const auto bracket =
      boost::math::tools::toms748_solve(excess, low, high, at_low, at_high, close_enough, iterations);
  return (bracket.first + bracket.second) / 2;
}

}  // namespace

Oscillation50 Oscillation50::about_zero(int sign) const {
  return {Real(0), sign * D, sign * r, gamma, omega_squared};
}

Oscillation50 Oscillation50::derivative(int sign) const {
  return {Real(0), sign * r, Real(sign * (-gamma * r - omega0_squared() * D)), gamma, omega_squared};
}

std::optional<Real> Oscillation50::first_extreme() const {
  // c′ = 0 where tan(ωt)/ω, tanh(κt)/κ or t has the value r/(γr/2 + ω₀²D).
  const Real denominator = gamma * r / 2 + omega0_squared() * D;
  if (omega_squared > 0) {
    const Real omega = sqrt(omega_squared);
    Real phase = atan2(Real(omega * r), denominator);
    while (phase <= 0) phase += pi50();
    return Real(phase / omega);
  }
  if (denominator == 0) return std::nullopt;
  const Real quotient = r / denominator;
  if (quotient <= 0) return std::nullopt;
  if (omega_squared == 0) return quotient;
  const Real kappa = sqrt(Real(-omega_squared));
  if (quotient * kappa >= 1) return std::nullopt;
  return Real(atanh(Real(kappa * quotient)) / kappa);
}

std::optional<Real> Oscillation50::first_rise(const Real& level) const {
  const Oscillation50 y = about_zero(1);
  const Real above = level - K;
  // Piece by piece between the extremes. The second maximum of a damped oscillation is no higher than the
  // first; one more piece takes in a start on a maximum.
  constexpr int kPieces = 3;
  Real start = 0;
  Real at_start = y.D;
  std::optional<Real> extreme = first_extreme();
  for (int piece = 0; piece < kPieces && extreme; ++piece) {
    const Real at_end = y.value(*extreme);
    if (at_end > at_start && at_end >= above) return root_between(y, above, start, *extreme);
    start = *extreme;
    at_start = at_end;
    if (y.omega_squared <= 0) break;
    *extreme += pi50() / sqrt(omega_squared);
  }
  if (omega_squared > 0) return std::nullopt;
  // What is left creeps to zero.
  if (!(at_start < above && above < 0)) return std::nullopt;
  Real step = 1 / gamma;
  while (y.value(start + step) < above) step *= 2;
  return root_between(y, above, start, start + step);
}

std::optional<Real> Oscillation50::first_fall(const Real& level) const {
  return about_zero(-1).first_rise(K - level);
}

std::optional<Real> Oscillation50::first_rise_of_rate(const Real& level) const {
  return derivative(1).first_rise(level);
}

std::optional<Real> Oscillation50::first_fall_of_rate(const Real& level) const {
  return derivative(-1).first_rise(-level);
}

}  // namespace stickslip::accuracy
