#include "core/sim/first_rise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/sim/bracket.hpp"

namespace stickslip::sim {
namespace {

using model::SlipWaveform;

bool reaches(double maximum, double level, Touch touch) {
  return touch == Touch::kCounts ? maximum >= level : maximum > level;
}

/// y of an oscillator with ω² > 0, with what does not change worked out once.
class Oscillation {
 public:
  explicit Oscillation(const SlipWaveform& y)
      : half_gamma_(y.oscillator.gamma_per_s / 2.0),
        omega_(y.oscillator.omega_rad_per_s()),
        omega0_squared_(y.oscillator.omega0_squared()),
        cosine_(y.D),
        sine_((y.r + half_gamma_ * y.D) / omega_),
        rate_cosine_(y.r),
        rate_sine_(-(half_gamma_ * y.r + omega0_squared_ * y.D) / omega_) {}

  [[nodiscard]] double half_period_s() const { return std::numbers::pi / omega_; }

  /// A maximum, in (−π/ω, π/ω]. [15]
  [[nodiscard]] double maximum_s() const { return std::atan2(rate_cosine_, -rate_sine_) / omega_; }

  [[nodiscard]] double value(double t_s) const {
    return std::exp(-half_gamma_ * t_s) * (cosine_ * std::cos(omega_ * t_s) + sine_ * std::sin(omega_ * t_s));
  }

  /// Where y rises to the level, between a minimum at or before `low` and the maximum at `high`.
  /// Halley's method, kept within the bracket, from the place that an undamped oscillation would have.
  [[nodiscard]] double crossing_s(double level, double low, double high, double top) const {
    const double bottom = -top * std::exp(half_gamma_ * half_period_s());
    const double place = (top + bottom - 2.0 * level) / (top - bottom);
    double t = high - half_period_s() * (1.0 - std::acos(std::clamp(place, -1.0, 1.0)) / std::numbers::pi);
    constexpr int kMaxSteps = 100;  // Three are needed, sixty if all were bisections.
    for (int step = 0; step < kMaxSteps; ++step) {
      if (!(t > low && t < high)) t = low + (high - low) / 2.0;
      if (!(t > low && t < high)) return high;  // No number is left between them.
      const double decay = std::exp(-half_gamma_ * t);
      const double cosine = std::cos(omega_ * t);
      const double sine = std::sin(omega_ * t);
      const double y = decay * (cosine_ * cosine + sine_ * sine);
      const double slope = decay * (rate_cosine_ * cosine + rate_sine_ * sine);
      const double excess = y - level;
      if (excess == 0.0) return t;
      (excess < 0.0 ? low : high) = t;
      const double curvature = -2.0 * half_gamma_ * slope - omega0_squared_ * y;
      const double newton = -excess / slope;
      const double bend = curvature / (2.0 * slope);
      const double halley = newton / (1.0 + newton * bend);
      t += halley;
      // What Halley leaves is of the order of the cube of its step.
      const double unit = std::max(std::abs(bend), omega_);
      const double left = unit * unit * std::abs(halley * halley * halley);
      if (left < std::numeric_limits<double>::epsilon() / 4.0 * t) return std::clamp(t, low, high);
    }
    return t;
  }

 private:
  double half_gamma_;
  double omega_;
  double omega0_squared_;
  double cosine_;  ///< y = e^(−γt/2) (cosine · cos ωt + sine · sin ωt), and y′ with the other two.
  double sine_;
  double rate_cosine_;
  double rate_sine_;
};

std::optional<double> oscillating(const SlipWaveform& slip, double level, Touch touch) {
  const Oscillation y{slip};
  double maximum = y.maximum_s();
  if (maximum <= 0.0) maximum += 2.0 * y.half_period_s();
  const double top = y.value(maximum);
  if (!reaches(top, level, touch)) return std::nullopt;
  const double low = maximum - y.half_period_s();
  if (low <= 0.0 && slip.D >= level) return 0.0;  // Only by rounding.
  return y.crossing_s(level, std::max(0.0, low), maximum, top);
}

/// ω² ≤ 0: at most one extreme, then a monotone approach to zero.
std::optional<double> creeping(const SlipWaveform& y, double level, Touch touch) {
  const double gamma = y.oscillator.gamma_per_s;
  const double omega0_squared = y.oscillator.omega0_squared();
  const double kappa = std::sqrt(-y.oscillator.omega_squared);
  const auto excess = [&y, level](double t) { return y.value(t) - level; };
  // y′ = 0 where tanh(κt)/κ has this value.
  const double quotient = y.r / (gamma * y.r / 2.0 + omega0_squared * y.D);
  std::optional<double> extreme;
  if (quotient > 0.0 && quotient * kappa < 1.0) {
    extreme = kappa > 0.0 ? std::atanh(kappa * quotient) / kappa : quotient;
  }
  if (y.r > 0.0 && extreme) {
    if (!reaches(y.value(*extreme), level, touch)) return std::nullopt;
    return rise_between(excess, 0.0, *extreme);
  }
  const bool rises_to_zero = y.r > 0.0 || extreme || y.D < 0.0;
  if (!rises_to_zero || level >= 0.0) return std::nullopt;
  const double low = extreme.value_or(0.0);
  double step = (gamma / 2.0 + kappa) / omega0_squared;  // The slow time constant.
  while (y.value(low + step) < level) step *= 2.0;
  return rise_between(excess, low, low + step);
}

}  // namespace

std::optional<double> first_rise_s(const SlipWaveform& y, double level, Touch touch) {
  return y.oscillator.oscillates() ? oscillating(y, level, touch) : creeping(y, level, touch);
}

}  // namespace stickslip::sim
