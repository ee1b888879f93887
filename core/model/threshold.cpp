#include "core/model/threshold.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include <boost/math/tools/toms748_solve.hpp>

namespace stickslip::model {
namespace {

using std::numbers::pi;

/// No error handling by exceptions: the brackets below hold by construction.
using Quiet = boost::math::policies::policy<
    boost::math::policies::evaluation_error<boost::math::policies::ignore_error>,
    boost::math::policies::domain_error<boost::math::policies::ignore_error>>;

template <typename Function>
double root_between(const Function& function, double low, double high) {
  const double at_low = function(low);
  const double at_high = function(high);
  // Bounds may coincide with the root to the last bit.
  if (at_low == 0.0 || std::signbit(at_low) == std::signbit(at_high)) {
    return std::abs(at_low) <= std::abs(at_high) ? low : high;
  }
  if (at_high == 0.0) return high;
  std::uintmax_t iterations = 200;  // Algorithm 748 needs about ten; bisection alone would need 60.
  const auto bracket = boost::math::tools::toms748_solve(
      function, low, high, at_low, at_high,
      boost::math::tools::eps_tolerance<double>(std::numeric_limits<double>::digits - 1), iterations,
      Quiet());
  return bracket.first + (bracket.second - bracket.first) / 2.0;
}

struct Threshold {
  double theta_rad;
  double Q;
};

/// Little damping: x is close to π/2, so solve for y = π/2 − θ, which carries the digits of Q ≈ 1/y.
Threshold lightly_damped(double t) {
  const double phi = std::atan(t);
  const auto excess = [t, phi](double y) {
    const double half_sine = std::sin(y / 2.0);
    // cos φ/sin x = 1/(cos y − tan φ sin y)
    return t * (2.0 * pi - 2.0 * phi - y) + std::log1p(-(2.0 * half_sine * half_sine + t * std::sin(y)));
  };
  // At 0 it is positive. −log1p(−u) ≥ u ≥ 2 sin²(y/2) ≥ 2 y²/π² on (0, π/2), so it is negative where
  // that exceeds 2π tan φ. Just below π/2 − φ, where the logarithm's argument becomes 0, it is negative, too:
  // ln 1e-6 ≈ −13 outweighs 2π kStrongDamping.
  constexpr double kJustBelow = 1.0 - 1e-6;
  const double beyond = std::fmin(pi * std::sqrt(pi * t), kJustBelow * std::atan2(1.0, t));
  const double y = root_between(excess, 0.0, beyond);
  return {pi / 2.0 - y, 1.0 / std::tan(y) - t};
}

/// Strong damping: x is small, and so is Q.
Threshold strongly_damped(double t) {
  const double phi = std::atan(t);
  const double log_cos_phi = -std::log1p(t * t) / 2.0;
  const auto excess = [t, phi, log_cos_phi](double x) {
    return t * (x - phi + 1.5 * pi) - (log_cos_phi - std::log(std::sin(x)));
  };
  // 0 ≤ x ≤ π/2 − φ inside the left side bounds sin x from both sides.
  const double low = std::asin(std::exp(log_cos_phi - t * (2.0 * pi - 2.0 * phi)));
  const double high = std::asin(std::exp(log_cos_phi - t * (1.5 * pi - phi)));
  const double x = root_between(excess, low, high);
  const double theta = x + phi;
  // tan θ − tan φ without the difference: sin x/(cos θ cos φ), cos θ = cos(x) cos φ − sin(x) sin φ.
  return {theta, std::sin(x) * (1.0 + t * t) / (std::cos(x) - t * std::sin(x))};
}

/// tan φ above which the form for strong damping is used; both forms hold in a wide range around it.
constexpr double kStrongDamping = 0.3;

Threshold threshold(double t) noexcept {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  if (!(t >= 0.0 && t <= kLargestGammaOver2Omega)) return {kNan, kNan};
  if (t == 0.0) return {pi / 2.0, std::numeric_limits<double>::infinity()};
  return t < kStrongDamping ? lightly_damped(t) : strongly_damped(t);
}

}  // namespace

double Q_threshold(double gamma_over_2omega) noexcept { return threshold(gamma_over_2omega).Q; }

double theta_threshold_rad(double gamma_over_2omega) noexcept {
  return threshold(gamma_over_2omega).theta_rad;
}

double threshold_speed_m_per_s(const Oscillator& oscillator, double delta_mu,
                               double gravity_m_per_s2) noexcept {
  return Q_threshold(oscillator.gamma_over_2omega()) * oscillator.omega_rad_per_s() * gravity_m_per_s2 *
         delta_mu / oscillator.omega0_squared();
}

double delta_mu_of_threshold_speed(const Oscillator& oscillator, double threshold_speed_m_per_s,
                                   double gravity_m_per_s2) noexcept {
  return oscillator.omega0_squared() * threshold_speed_m_per_s /
         (Q_threshold(oscillator.gamma_over_2omega()) * oscillator.omega_rad_per_s() * gravity_m_per_s2);
}

}  // namespace stickslip::model
