#include "core/model/capture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <boost/math/tools/toms748_solve.hpp>

namespace stickslip::model {
namespace {

/// Root of a function with different signs at the ends. Algorithm 748 [Alefeld, Potra and Shi, ACM TOMS
/// 21(3):327–344, 1995] keeps the bracket.
template <typename Function>
double root_between(const Function& function, double low, double high, double at_low, double at_high) {
  std::uintmax_t iterations = 100;
  const auto bracket = boost::math::tools::toms748_solve(
      function, low, high, at_low, at_high, boost::math::tools::eps_tolerance<double>(50), iterations);
  return 0.5 * (bracket.first + bracket.second);
}

/// Error of the time left by the last step, relative to the time: half a unit in the last place.
constexpr double kSettled = 1e-16;
/// Step, relative to t₃, at which the search ends near a double root: there a step divides the error only by
/// three, and the root is determined to √ε = 1.5e-8 at best.
constexpr double kSettledStep = 1e-9;
/// Limit of the number of steps; bisection alone needs 50.
constexpr int kMostSteps = 60;

/// Halley's step towards c′ = belt rate, for which c‴ = −γ c″ − ω₀² c′ is at hand.
struct CaptureStep {
  double length_s = 0.0;
  double excess = 0.0;        ///< c′ less the rate, before it.
  double acceleration = 0.0;  ///< c″, before it.
  /// Nothing is left of the error but rounding.
  bool exact = false;
};

CaptureStep step_from(double t_s, const SlipWaveform& slip, double belt_rate_per_s) noexcept {
  const SlipWaveform::Motion motion = slip.motion(t_s);
  const Oscillator& oscillator = slip.oscillator;
  const double omega0_squared = oscillator.omega0_squared();
  const double excess = motion.rate - belt_rate_per_s;
  const double newton = excess / motion.acceleration;
  const double bend = -0.5 * newton *
                      (oscillator.gamma_per_s * motion.acceleration + omega0_squared * motion.rate) /
                      motion.acceleration;
  // The error left is the step times the squares of what bends c′ over it [Traub, Iterative Methods,
  // 1964, 5.1].
  const double phase_squared = oscillator.omega_squared * newton * newton;
  const bool exact = std::abs(newton) * (bend * bend + phase_squared) <= kSettled * t_s;
  return {-newton / (1.0 - bend), excess, motion.acceleration, exact};
}

}  // namespace

std::optional<double> capture_time_s(const SlipWaveform& slip, double belt_rate_per_s) noexcept {
  const double omega = slip.oscillator.omega_rad_per_s();
  const double t2 = slip.fastest_slip_time_s();
  const double t3 = t2 + std::numbers::pi / omega;
  const double rate_at_end = slip.rate(t3);
  if (!(rate_at_end >= belt_rate_per_s)) return std::nullopt;
  // c′ turns round at t₃ and, half an oscillation before, at t₂: there it has the other sign.
  if (!(belt_rate_per_s > 0.0) && slip.rate(t2) >= belt_rate_per_s) return t2;
  if (rate_at_end == belt_rate_per_s) return t3;
  // About its maximum c′ is nearly a cosine: from there by steps. What leads out of the bracket, which closes
  // with each, is replaced by its middle.
  double low = t2;
  double high = t3;
  double t = t3 - std::acos(std::clamp(belt_rate_per_s / rate_at_end, -1.0, 1.0)) / omega;
  for (int step = 0; step < kMostSteps; ++step) {
    const CaptureStep taken = step_from(t, slip, belt_rate_per_s);
    (taken.excess < 0.0 ? low : high) = t;
    double next = t + taken.length_s;
    const bool inside = next >= low && next <= high;
    if (!inside) next = 0.5 * (low + high);
    const bool settled = (taken.exact && inside) || std::abs(next - t) <= kSettledStep * t3;
    t = next;
    if (settled) break;
  }
  return t;
}

std::optional<double> capture_time_near_s(const SlipWaveform& slip, double belt_rate_per_s,
                                          double near_s) noexcept {
  constexpr int kMostNearSteps = 6;
  const double quarter_s = 0.5 * std::numbers::pi / slip.oscillator.omega_rad_per_s();
  double t = near_s;
  for (int step = 0; step < kMostNearSteps; ++step) {
    const CaptureStep taken = step_from(t, slip, belt_rate_per_s);
    t += taken.length_s;
    // c′ rises from t₂ to t₃ alone.
    if (!(taken.acceleration > 0.0 && std::abs(t - near_s) < quarter_s)) return std::nullopt;
    if (taken.exact) return t;
  }
  return std::nullopt;
}

double deciding_time_s(const SlipWaveform& slip, const BeltMotion& belt, double r, double onset_s) noexcept {
  const double t3 = slip.rise_end_time_s();
  if (belt.is_constant()) return t3;
  const auto excess_slope = [&](double t_s) {
    return slip.acceleration(t_s) - r * belt.slope(onset_s + t_s);
  };
  // c″ falls through zero at t₃, from its largest to its least value a quarter of an oscillation away.
  const double quarter_s = std::numbers::pi / 2.0 / slip.oscillator.omega_rad_per_s();
  const double before = excess_slope(t3 - quarter_s);
  const double after = excess_slope(t3 + quarter_s);
  if (!(before > 0.0 && after < 0.0)) return t3;
  return root_between(excess_slope, t3 - quarter_s, t3 + quarter_s, before, after);
}

std::optional<double> capture_time_s(const SlipWaveform& slip, const BeltMotion& belt, double r,
                                     double onset_s) noexcept {
  if (belt.is_constant()) return capture_time_s(slip, r);
  const auto excess = [&](double t_s) { return slip.rate(t_s) - belt.stick_rate(r, onset_s + t_s); };
  const double t2 = slip.fastest_slip_time_s();
  const double end = deciding_time_s(slip, belt, r, onset_s);
  const double at_end = excess(end);
  if (!(at_end >= 0.0)) return std::nullopt;
  const double at_begin = excess(t2);
  if (at_begin >= 0.0) return t2;
  if (at_end == 0.0) return end;
  return root_between(excess, t2, end, at_begin, at_end);
}

}  // namespace stickslip::model
