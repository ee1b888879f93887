#include "core/model/threshold.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/accuracy/oscillation50.hpp"
#include "core/model/capture.hpp"
#include "core/model/closed_forms.hpp"
#include "core/model/slip_waveform.hpp"

namespace stickslip::model {
namespace {

using accuracy::Real;

constexpr double kDegree = std::numbers::pi / 180.0;

/// Q_th by bisection of [22] in 50 digits.
Real reference_Q_threshold(double gamma_over_2omega) {
  const Real t = gamma_over_2omega;
  const Real phi = atan(t);
  const Real half_pi = accuracy::pi50() / 2;
  Real low = 0;
  Real high = half_pi - phi;
  for (int step = 0; step < 2000 && high - low > Real("1e-46") * high; ++step) {
    const Real x = (low + high) / 2;
    const bool above = t * (x - phi + 3 * half_pi) > log(cos(phi) / sin(x));
    (above ? high : low) = x;
  }
  // tan θ − tan φ as one quotient: x may be below 1e-50.
  return sin(low) * (1 + t * t) / (cos(low) - t * sin(low));
}

TEST(Threshold, TenDigitsOfThePapersCase) {
  EXPECT_NEAR(Q_threshold(0.022), 1.93871744784, 0.5e-11);
  EXPECT_NEAR(theta_threshold_rad(0.022) / kDegree, 62.9776275948, 0.5e-10);
  const double half_life_of_five = std::numbers::ln2 / (10.0 * std::numbers::pi);
  EXPECT_NEAR(Q_threshold(half_life_of_five), 1.93579678601, 0.5e-11);
  EXPECT_NEAR(theta_threshold_rad(half_life_of_five) / kDegree, 62.9437969991, 0.5e-10);
}

TEST(Threshold, AgreesWithFiftyDigitsOverTheWholeDomain) {
  for (const double t : {1e-12, 1e-6, 1e-3, 0.022, 0.1, 0.29999, 0.3, 0.30001, 1.0, 5.0, 40.0}) {
    const double reference = static_cast<double>(reference_Q_threshold(t));
    // Condition: the exponent 2π tan φ carries ε, and Q follows it one to one for strong damping.
    EXPECT_NEAR(Q_threshold(t) / reference, 1.0, 1e-15 * (8.0 + 2.0 * std::numbers::pi * t)) << t;
  }
}

// Falls everywhere: no damping in between has no threshold, or that of another.
TEST(Threshold, FallsWithTheDampingAtEachOfAMillionSteps) {
  constexpr int kSteps = 1'000'000;
  constexpr double kLargest = 1.0;
  double before = Q_threshold(0.0);
  for (int i = 1; i <= kSteps; ++i) {
    const double gamma_over_2omega = kLargest * i / kSteps;
    const double now = Q_threshold(gamma_over_2omega);
    ASSERT_LT(now, before) << "at gamma/2omega = " << gamma_over_2omega;
    before = now;
  }
}

TEST(Threshold, EndsOfTheDomainAreDefined) {
  EXPECT_TRUE(std::isinf(Q_threshold(0.0)));
  EXPECT_DOUBLE_EQ(theta_threshold_rad(0.0), std::numbers::pi / 2.0);
  EXPECT_TRUE(std::isnan(Q_threshold(-1e-9)));
  EXPECT_TRUE(std::isnan(Q_threshold(kLargestGammaOver2Omega * 1.01)));
  EXPECT_GT(Q_threshold(kLargestGammaOver2Omega), 0.0);
}

// Q_th ≈ 1/√(4πφ); the next term is of relative order √φ.
TEST(Threshold, ApproachesItsAsymptoteForLittleDamping) {
  for (const double t : {1e-4, 1e-6, 1e-8}) {
    EXPECT_NEAR(Q_threshold(t) * std::sqrt(4.0 * std::numbers::pi * t), 1.0, 10.0 * std::sqrt(t)) << t;
  }
}

TEST(Threshold, SpeedAndDeltaMuAreConverse) {
  const Oscillator oscillator = Oscillator::from_omega(125.0, 0.022);
  const double speed = threshold_speed_m_per_s(oscillator, 0.05, 9.8);
  EXPECT_NEAR(dimensionless_speed(oscillator.stick_rate_per_s(speed, 9.8), 125.0, 0.05), Q_threshold(0.022),
              1e-14);
  EXPECT_NEAR(delta_mu_of_threshold_speed(oscillator, speed, 9.8), 0.05, 1e-16);
}

// [21], the definition: at the threshold c′(t₃) = r. Its sign decides in plain double.
TEST(Threshold, RateAtTheEndOfTheRiseDecidesToTenDigitsOnEachSide) {
  const double t = 0.022;
  const double omega = 125.0;
  const auto margin = [&](double Q) {
    const SlipWaveform slip{0.30, 0.05, Q * omega * 0.05, Oscillator::from_omega(omega, t)};
    return slip.rate(slip.rise_end_time_s()) / slip.r - 1.0;
  };
  for (int n = 2; n <= 13; ++n) {
    const double step = std::pow(10.0, -n);
    EXPECT_GT(margin(Q_threshold(t) * (1.0 - step)), 0.0) << n;
    EXPECT_LT(margin(Q_threshold(t) * (1.0 + step)), 0.0) << n;
  }
}

// Whether a slip ends in sticking is told by the largest slip speed alone: ρ ≥ e^(πε). Both sides are closed
// forms of the same sinusoid, ε e^(πε) ρ and a few roundings apart.
TEST(Threshold, SlipSpeedRatioDecidesWithoutSMinusKOrSpeed) {
  constexpr double kRounding = 1e-13;
  for (const double t : {0.0, 1e-6, 0.01, 0.022, 0.1, 0.3, 1.0}) {
    const double limit = slip_speed_ratio_threshold(t);
    EXPECT_DOUBLE_EQ(limit, std::exp(std::numbers::pi * t));
    const double reference = t > 0.0 ? Q_threshold(t) : 1.0;
    for (const double part : {0.05, 0.3, 0.62, 0.77, 0.9, 0.99, 0.9999, 1.0001, 1.01, 1.1, 1.5, 3.0, 20.0}) {
      const double Q = part * reference;
      const SlipWaveform slip{0.30, 0.05, Q * 125.0 * 0.05, Oscillator::from_omega(125.0, t)};
      const double ratio = slip_speed_ratio(Q, t);
      EXPECT_NEAR(ratio / limit, slip.rate(slip.rise_end_time_s()) / slip.r, kRounding * ratio)
          << t << ' ' << part;
      const bool sticks = capture_time_s(slip, slip.r).has_value();
      EXPECT_EQ(ratio >= limit, sticks) << t << ' ' << part;
      EXPECT_EQ(sticks, t == 0.0 || part < 1.0);
    }
    if (t > 0.0) {
      EXPECT_NEAR(slip_speed_ratio(Q_threshold(t), t) / limit, 1.0, kRounding) << t;
    }
  }
  // What the paper's tester needs to know it by: 1.072 against 1.207 at 12 in/min.
  EXPECT_NEAR(slip_speed_ratio_threshold(0.022), 1.072, 5e-4);
  const Oscillator oscillator = Oscillator::from_omega(2.0 * std::numbers::pi * 20.0, 0.022);
  const double Q = dimensionless_speed(oscillator.stick_rate_per_s(12.0 * 0.0254 / 60.0, 9.80665),
                                       oscillator.omega_rad_per_s(), 0.05);
  EXPECT_NEAR(slip_speed_ratio(Q, 0.022), 1.207, 5e-4);
}

}  // namespace
}  // namespace stickslip::model
