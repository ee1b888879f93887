#include "core/model/inversion.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

#include <boost/math/tools/toms748_solve.hpp>

#include "core/model/capture.hpp"
#include "core/model/closed_forms.hpp"
#include "core/model/slip_waveform.hpp"
#include "core/model/threshold.hpp"

namespace stickslip::model {
namespace {

constexpr double kSlowest = 1e-6;
constexpr double kFastest = 1e6;
constexpr double kStrongestDamping = 1.0;

bool in_domain(double t) noexcept { return t >= 0.0 && t <= kStrongestDamping; }

/// Steps of Newton's method from a neighbour, and the step in ln Q after which it has converged: what is left
/// is smaller by the relative distance of the neighbour.
constexpr int kNewtonSteps = 8;
constexpr double kNewtonConverged = 1e-9;

/// \param forward  of Q, positive and falling in [low, high]. \param near  of a value near this one.
template <typename Forward>
std::optional<InvertedSpeed> invert(const Forward& forward, double value, double low, double high,
                                    const std::optional<InvertedSpeed>& near = {}) noexcept {
  if (!(value > 0.0) || !std::isfinite(value)) return std::nullopt;
  // In logarithms: both sides are nearly straight lines there.
  const auto excess = [&](double log_Q) { return std::log(forward(std::exp(log_Q))) - std::log(value); };
  if (near) {
    double log_Q = std::log(near->Q);
    for (int i = 0; i < kNewtonSteps; ++i) {
      const double step = near->condition * excess(log_Q);
      if (!(std::abs(step) < 1.0)) break;
      log_Q += step;
      if (std::abs(step) < kNewtonConverged) return InvertedSpeed{std::exp(log_Q), near->condition};
    }
  }
  double log_low = std::log(low);
  double log_high = std::log(high);
  const double at_low = excess(log_low);
  const double at_high = excess(log_high);
  if (!(at_low > 0.0 && at_high < 0.0)) return std::nullopt;
  std::uintmax_t iterations = 200;  // Algorithm 748 needs about ten; bisection alone would need 60.
  const auto bracket = boost::math::tools::toms748_solve(
      excess, log_low, log_high, at_low, at_high,
      boost::math::tools::eps_tolerance<double>(std::numeric_limits<double>::digits - 2), iterations);
  const double log_Q = 0.5 * (bracket.first + bracket.second);
  // Third root of ε: as far as a central difference gets.
  constexpr double kStep = 6e-6;
  const double up = std::fmin(log_Q + kStep, log_high);
  const double down = std::fmax(log_Q - kStep, log_low);
  const double slope = (excess(up) - excess(down)) / (up - down);
  if (!(slope < 0.0)) return std::nullopt;
  return InvertedSpeed{std::exp(log_Q), -1.0 / slope};
}

/// In units of r/ω for c and 1/ω for t: K = 0, D = 1/Q, r = 1.
SlipWaveform dimensionless_slip(double Q, double t) noexcept {
  return {0.0, 1.0 / Q, 1.0, Oscillator::from_omega(1.0, t)};
}

/// Period of a cycle whose slip ends at capture_s: the slip, and the stick that climbs back to S.
double phase_from(const SlipWaveform& slip, double capture_s) noexcept {
  return capture_s + (slip.D - slip.value(capture_s));
}

}  // namespace

std::optional<InvertedSpeed> Q_of_amplitude(double amplitude_over_belt, double gamma_over_2omega,
                                            const std::optional<InvertedSpeed>& near) noexcept {
  if (!in_domain(gamma_over_2omega)) return std::nullopt;
  return invert([=](double Q) { return amplitude_ratio(Q, gamma_over_2omega) / Q; }, amplitude_over_belt,
                kSlowest, kFastest, near);
}

std::optional<InvertedSpeed> Q_of_slip_speed_ratio(double ratio, double gamma_over_2omega,
                                                   const std::optional<InvertedSpeed>& near) noexcept {
  if (!in_domain(gamma_over_2omega)) return std::nullopt;
  return invert([=](double Q) { return slip_speed_ratio(Q, gamma_over_2omega); }, ratio, kSlowest, kFastest,
                near);
}

std::optional<InvertedSpeed> Q_of_period(double period_phase, double gamma_over_2omega) noexcept {
  if (!in_domain(gamma_over_2omega)) return std::nullopt;
  // Near the threshold rounding decides whether the sled sticks; below it the sled does, at the latest where
  // it comes nearest to the belt's speed.
  const double fastest = std::fmin(Q_threshold(gamma_over_2omega) * (1.0 - 1e-12), kFastest);
  return invert(
      [=](double Q) {
        const SlipWaveform slip = dimensionless_slip(Q, gamma_over_2omega);
        return phase_from(slip, capture_time_s(slip, slip.r).value_or(slip.rise_end_time_s()));
      },
      period_phase, kSlowest, fastest);
}

std::optional<double> period_phase_rad(double Q, double gamma_over_2omega) noexcept {
  const SlipWaveform slip = dimensionless_slip(Q, gamma_over_2omega);
  const auto capture = capture_time_s(slip, slip.r);
  if (!capture) return std::nullopt;
  return phase_from(slip, *capture);
}

std::optional<double> cycle_mean_excess(double Q, double gamma_over_2omega) noexcept {
  const SlipWaveform slip = dimensionless_slip(Q, gamma_over_2omega);
  const auto capture = capture_time_s(slip, slip.r);
  if (!capture) return std::nullopt;
  const double at_capture = slip.value(*capture);
  const double climb = slip.D - at_capture;
  // The integral of c″ + γ c′ + ω₀² (c − K) = 0 over the slip, which begins and ends with c′ = r.
  const double over_slip = slip.oscillator.gamma_per_s * climb / slip.oscillator.omega0_squared();
  const double over_stick = 0.5 * climb * (slip.D + at_capture);
  return (over_slip + over_stick) / (*capture + climb) / slip.D;
}

}  // namespace stickslip::model
