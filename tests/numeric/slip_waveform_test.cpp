#include "core/model/slip_waveform.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/accuracy/oscillation50.hpp"
#include "core/model/closed_forms.hpp"

namespace stickslip::model {
namespace {

using std::numbers::pi;

constexpr double kOmega = 2.0 * pi * 20.0;

SlipWaveform slip_at(double Q, double gamma_over_2omega, double D = 0.05) {
  return {0.30, D, Q * kOmega * D, Oscillator::from_omega(kOmega, gamma_over_2omega)};
}

TEST(SlipWaveform, AgreesWithFiftyDigits) {
  for (const double D : {0.05, 1e-6, 1e-15, 0.0}) {
    for (const double gamma_over_2omega : {0.0, 0.022, 0.5, 20.0}) {
      const SlipWaveform slip{0.30, D, 8.0, Oscillator::from_omega(kOmega, gamma_over_2omega)};
      const accuracy::Oscillation50 reference{slip.K, slip.D, slip.r, slip.oscillator.gamma_per_s,
                                              slip.oscillator.omega_squared};
      for (const double t : {0.0, 1e-7, 0.001, 0.01, 0.04, 0.3}) {
        // Arguments up to ωt(1 + γ/2ω) carry ε each; c and c′/ω are of the order 0.4 or less.
        const double tolerance = 4e-16 * (1.0 + kOmega * t * (1.0 + gamma_over_2omega));
        EXPECT_NEAR(slip.value(t), static_cast<double>(reference.value(t)), tolerance);
        EXPECT_NEAR(slip.rate(t), static_cast<double>(reference.rate(t)),
                    tolerance * kOmega * (1.0 + gamma_over_2omega));
      }
    }
  }
}

TEST(SlipWaveform, SolvesItsEquationAndStartsAsThePaperSays) {
  const SlipWaveform slip = slip_at(1.3, 0.022);
  EXPECT_DOUBLE_EQ(slip.value(0.0), 0.35);   // [13]
  EXPECT_DOUBLE_EQ(slip.rate(0.0), slip.r);  // [14]
  for (const double t : {0.0, 0.005, 0.02, 0.045}) {
    const double residual = slip.acceleration(t) + slip.oscillator.gamma_per_s * slip.rate(t) +
                            slip.oscillator.omega0_squared() * (slip.value(t) - slip.K);
    EXPECT_NEAR(residual, 0.0, 1e-12 * slip.oscillator.omega0_squared() * slip.D) << t;
  }
}

TEST(SlipWaveform, TimesAreExtremesOfForceAndSpeed) {
  const double t = 0.022;
  for (const double Q : {1e-12, 0.3, 1.3, 1.94, 50.0, 1e9}) {
    const SlipWaveform slip = slip_at(Q, t);
    const double scale = slip.r + kOmega * slip.D;
    EXPECT_NEAR(kOmega * slip.peak_time_s(), theta_rad(Q, t) - std::atan(t), 4e-16);  // [15]
    EXPECT_NEAR(slip.rate(slip.peak_time_s()), 0.0, 1e-14 * scale);
    EXPECT_NEAR(slip.rate(slip.trough_time_s()), 0.0, 1e-14 * scale);
    EXPECT_NEAR(slip.acceleration(slip.fastest_slip_time_s()), 0.0, 1e-14 * scale * kOmega);  // [16]
    EXPECT_NEAR(slip.acceleration(slip.rise_end_time_s()), 0.0, 1e-14 * scale * kOmega);      // [20]
  }
}

TEST(SlipWaveform, EquationsElevenAndTwelveHold) {
  const double t = 0.022;
  const double Q = 1.3;
  const SlipWaveform slip = slip_at(Q, t);
  const double theta = theta_rad(Q, t);
  const double phi = std::atan(t);
  for (const double time : {0.0, 0.01, 0.03}) {
    const double decay = std::exp(-slip.oscillator.gamma_per_s * time / 2.0);
    EXPECT_NEAR(slip.value(time), 0.30 + 0.05 * decay * std::cos(kOmega * time - theta) / std::cos(theta),
                1e-15);
    EXPECT_NEAR(
        slip.rate(time),
        -kOmega * 0.05 * decay * std::sin(kOmega * time - theta + phi) / (std::cos(theta) * std::cos(phi)),
        1e-13);
  }
}

TEST(SlipWaveform, AmplitudeAndSpeedRatioAreThoseOfTheClosedForms) {
  for (const double t : {0.0, 0.022, 0.2}) {
    for (const double Q : {0.01, 0.5, 1.3, 1.9, 30.0}) {
      const SlipWaveform slip = slip_at(Q, t);
      const double range = slip.value(slip.peak_time_s()) - slip.value(slip.trough_time_s());
      EXPECT_NEAR(range / (2.0 * slip.D), amplitude_ratio(Q, t), 1e-13 * amplitude_ratio(Q, t));  // [17]
      const double speed_ratio = -slip.rate(slip.fastest_slip_time_s()) / slip.r;
      EXPECT_NEAR(speed_ratio, slip_speed_ratio(Q, t), 1e-13 * speed_ratio);  // [18]
    }
  }
}

}  // namespace
}  // namespace stickslip::model
