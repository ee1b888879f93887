#include "core/model/closed_forms.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace stickslip::model {
namespace {

using std::numbers::pi;

struct Row {
  double speed_in_per_min;
  double Q;
  double apparent_static;
  double frequency_Hz;
};

TEST(ClosedForms, ReproduceTable1) {
  const double omega = 2.0 * pi * 20.0;
  const double gravity_in_per_s2 = 384.0;  // 32 ft/s², the paper's own.
  for (const Row& row : {Row{3, 0.327249, 0.35260922, 12.711701}, Row{6, 0.654498, 0.35975718, 17.082159},
                         Row{12, 1.308997, 0.38236311, 19.314034}}) {
    const double r = omega * omega * row.speed_in_per_min / 60.0 / gravity_in_per_s2;
    const double Q = dimensionless_speed(r, omega, 0.05);
    EXPECT_NEAR(Q, row.Q, 0.5e-6);  // Half of the last printed digit, here and below.
    EXPECT_NEAR(undamped_maximum(0.30, 0.05, Q), row.apparent_static, 0.5e-8);
    const double period = (undamped_stick_phase_rad(Q) + undamped_slip_phase_rad(Q)) / omega;
    EXPECT_NEAR(1.0 / period, row.frequency_Hz, 0.5e-6);
  }
}

TEST(ClosedForms, AmplitudeRatioWithoutDampingIsEquation2) {
  for (const double Q : {0.0, 1e-9, 0.3, 1.3, 1e9}) {
    EXPECT_NEAR(amplitude_ratio(Q, 0.0), std::hypot(1.0, Q), 1e-15 * std::hypot(1.0, Q));
  }
}

TEST(ClosedForms, StayFiniteAtBothEndsOfTheSpeed) {
  EXPECT_NEAR(peak_phase_rad(1e-300, 0.022), 1e-300 / (1.0 + 0.022 * 0.022), 1e-315);
  EXPECT_DOUBLE_EQ(peak_phase_rad(std::numeric_limits<double>::infinity(), 0.022),
                   pi / 2.0 - std::atan(0.022));
  EXPECT_DOUBLE_EQ(peak_phase_rad(1e300, 0.022), pi / 2.0 - std::atan(0.022));
  EXPECT_TRUE(std::isfinite(amplitude_ratio(1e300, 0.022)));
  EXPECT_TRUE(std::isfinite(slip_speed_ratio(1e300, 0.022)));
  EXPECT_TRUE(std::isinf(dimensionless_speed(8.0, 125.0, 0.0)));
}

TEST(ClosedForms, HalfLifeOfFiveCyclesIsThePapersDamping) {
  EXPECT_NEAR(gamma_over_2omega_of_half_life(5.0), 0.0220635600153, 0.5e-13);
  // [19] n cycles of e^(−2π tan φ) each are one half.
  EXPECT_NEAR(std::exp(-2.0 * pi * gamma_over_2omega_of_half_life(5.0) * 5.0), 0.5, 1e-15);
}

TEST(ClosedForms, HalfLifeWithoutDampingIsForEver) {
  // One quotient, correctly rounded but for ln 2/2π: no cycles are too many.
  for (const double cycles : {1e3, 1e12, 1e150, 1e300}) {
    EXPECT_NEAR(gamma_over_2omega_of_half_life(cycles) * cycles / (std::numbers::ln2 / (2.0 * pi)), 1.0,
                1e-15);
  }
  EXPECT_EQ(gamma_over_2omega_of_half_life(std::numeric_limits<double>::infinity()), 0.0);
  EXPECT_EQ(amplitude_ratio(1.3, gamma_over_2omega_of_half_life(1e300)), amplitude_ratio(1.3, 0.0));
}

}  // namespace
}  // namespace stickslip::model
