#include "core/sim/first_rise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/sim/bracket.hpp"

namespace stickslip::sim {
namespace {

using friction::SlipWaveform;
/// \param low,high  y rises monotonically from at most the level to at least the level.
double crossing_between(const SlipWaveform& y, double level, double low, double high) {
  return rise_between([&y, level](double t) { return y.value(t) - level; }, low, high);
}

bool reaches(double maximum, double level, Touch touch) {
  return touch == Touch::kCounts ? maximum >= level : maximum > level;
}

std::optional<double> oscillating(const SlipWaveform& y, double level, Touch touch) {
  const double half_period = std::numbers::pi / y.oscillator.omega_rad_per_s();
  double maximum = y.peak_time_s();
  if (maximum <= 0.0) maximum += 2.0 * half_period;
  if (!reaches(y.value(maximum), level, touch)) return std::nullopt;
  return crossing_between(y, level, std::max(0.0, maximum - half_period), maximum);
}

/// ω² ≤ 0: at most one extreme, then a monotone approach to zero.
std::optional<double> creeping(const SlipWaveform& y, double level, Touch touch) {
  const double gamma = y.oscillator.gamma_per_s;
  const double omega0_squared = y.oscillator.omega0_squared();
  const double kappa = std::sqrt(-y.oscillator.omega_squared);
  // y′ = 0 where tanh(κt)/κ has this value.
  const double quotient = y.r / (gamma * y.r / 2.0 + omega0_squared * y.D);
  std::optional<double> extreme;
  if (quotient > 0.0 && quotient * kappa < 1.0) {
    extreme = kappa > 0.0 ? std::atanh(kappa * quotient) / kappa : quotient;
  }
  if (y.r > 0.0 && extreme) {
    if (!reaches(y.value(*extreme), level, touch)) return std::nullopt;
    return crossing_between(y, level, 0.0, *extreme);
  }
  const bool rises_to_zero = y.r > 0.0 || extreme || y.D < 0.0;
  if (!rises_to_zero || level >= 0.0) return std::nullopt;
  const double low = extreme.value_or(0.0);
  double step = (gamma / 2.0 + kappa) / omega0_squared;  // The slow time constant.
  while (y.value(low + step) < level) step *= 2.0;
  return crossing_between(y, level, low, low + step);
}

}  // namespace

std::optional<double> first_rise_s(const SlipWaveform& y, double level, Touch touch) {
  return y.oscillator.oscillates() ? oscillating(y, level, touch) : creeping(y, level, touch);
}

}  // namespace stickslip::sim
