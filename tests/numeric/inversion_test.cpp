#include "core/model/inversion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/model/closed_forms.hpp"
#include "core/model/threshold.hpp"
#include "core/model/uniform_trajectory.hpp"

namespace stickslip::model {
namespace {

constexpr double kDamping = 0.022;  // [19]

/// Each inverse amplifies the rounding of its argument by the condition number; the closed forms themselves
/// lose a few ε, and the root is found to 2 ε of ln Q.
double tolerance(const InvertedSpeed& found) {
  return 16.0 * std::numeric_limits<double>::epsilon() * (1.0 + found.condition) *
         (1.0 + std::abs(std::log(found.Q)));
}

TEST(Inversion, GivesBackTheSpeedUpToTheThreshold) {
  for (const double t : {0.0, 1e-6, kDamping, 0.3}) {
    const double threshold = std::fmin(Q_threshold(t), 1e3);
    for (const double part : {1e-4, 0.1, 0.5, 0.9, 1.0 - 1e-6, 1.0 - 1e-11}) {
      const double Q = part * threshold;
      const auto by_amplitude = Q_of_amplitude(amplitude_ratio(Q, t) / Q, t);
      const auto by_slip_speed = Q_of_slip_speed_ratio(slip_speed_ratio(Q, t), t);
      ASSERT_TRUE(by_amplitude && by_slip_speed) << Q << " " << t;
      EXPECT_NEAR(by_amplitude->Q / Q, 1.0, tolerance(*by_amplitude)) << Q << " " << t;
      EXPECT_NEAR(by_slip_speed->Q / Q, 1.0, tolerance(*by_slip_speed)) << Q << " " << t;
      const auto period = period_phase_rad(Q, t);
      ASSERT_TRUE(period) << Q << " " << t;
      const auto by_period = Q_of_period(*period, t);
      // From here to the threshold the period falls by less than its own rounding: there is no answer.
      if ((1.0 - part) * 2.0 / (Q * (1.0 + Q * Q)) <
          64.0 * std::numeric_limits<double>::epsilon() * *period) {
        continue;
      }
      ASSERT_TRUE(by_period) << Q << " " << t;
      // The capture is found to 2⁻⁵⁰ of itself.
      EXPECT_NEAR(by_period->Q / Q, 1.0, 8.0 * tolerance(*by_period)) << Q << " " << t;
    }
  }
}

// Rounding decides at thresholds so high whether a slip there is captured: no period may have no answer by
// that.
TEST(Inversion, PeriodTellsQAtEveryLightDamping) {
  for (int i = 0; i < 4000; ++i) {
    const double t = std::pow(10.0, -13.0 + 10.0 * i / 4000.0);
    for (const double Q : {0.1, 0.7, 3.0}) {
      const auto period = period_phase_rad(Q, t);
      ASSERT_TRUE(period) << Q << " " << t;
      const auto found = Q_of_period(*period, t);
      ASSERT_TRUE(found) << Q << " " << t;
      ASSERT_NEAR(found->Q / Q, 1.0, 8.0 * tolerance(*found)) << Q << " " << t;
    }
    // Of the free oscillation's period, or one just above it, Q is at the threshold, or no number is given.
    for (const double beyond : {0.0, 1e-15, 1e-12, 1e-9}) {
      const auto found = Q_of_period(2.0 * std::numbers::pi * (1.0 + beyond), t);
      ASSERT_TRUE(!found || found->Q > 1.0) << t << " " << found->Q;
    }
  }
}

// The last step of Newton's method, 1e-9 of ln Q, leaves that times the neighbour's distance. Where the
// neighbour is too far, or there is no answer, it is as without one.
TEST(Inversion, IsTheSameFromANeighbour) {
  const auto near = Q_of_amplitude(amplitude_ratio(1.0, kDamping) / 1.0, kDamping);
  ASSERT_TRUE(near);
  for (const double Q : {1e-3, 0.5, 0.9, 1.0, 1.1, 1.5, 1.9}) {
    const double amplitude = amplitude_ratio(Q, kDamping) / Q;
    const double ratio = slip_speed_ratio(Q, kDamping);
    const auto by_amplitude = Q_of_amplitude(amplitude, kDamping, near);
    const auto by_slip_speed = Q_of_slip_speed_ratio(
        ratio, kDamping, Q_of_slip_speed_ratio(slip_speed_ratio(1.0, kDamping), kDamping));
    ASSERT_TRUE(by_amplitude && by_slip_speed) << Q;
    EXPECT_NEAR(by_amplitude->Q / Q, 1.0, 1e-9) << Q;
    EXPECT_NEAR(by_slip_speed->Q / Q, 1.0, 1e-9) << Q;
  }
  EXPECT_FALSE(Q_of_amplitude(-1.0, kDamping, near));
}

TEST(Inversion, IsPoorNearTheThreshold) {
  // Without damping [2], [18]: x² = 1 + Q⁻², so that d ln Q/d ln x = −(1 + Q²).
  for (const double Q : {0.2, 1.0, 3.0}) {
    EXPECT_NEAR(Q_of_slip_speed_ratio(slip_speed_ratio(Q, 0.0), 0.0)->condition / (1.0 + Q * Q), 1.0, 1e-8);
    EXPECT_NEAR(Q_of_amplitude(amplitude_ratio(Q, 0.0) / Q, 0.0)->condition / (1.0 + Q * Q), 1.0, 1e-8);
  }
  const double threshold = Q_threshold(kDamping);
  EXPECT_GT(Q_of_slip_speed_ratio(slip_speed_ratio(threshold, kDamping), kDamping)->condition, 4.0);
  EXPECT_LT(Q_of_slip_speed_ratio(slip_speed_ratio(0.5 * threshold, kDamping), kDamping)->condition, 2.1);
}

TEST(Inversion, HasNoAnswerWhereThereIsNone) {
  // [18] for Q → ∞: nothing slips faster than the belt's own swing.
  const double limit = slip_speed_ratio(1e12, kDamping);
  EXPECT_LT(limit, 1.0);
  EXPECT_FALSE(Q_of_slip_speed_ratio(limit * (1.0 - 1e-9), kDamping));
  EXPECT_FALSE(Q_of_slip_speed_ratio(0.0, kDamping));
  EXPECT_FALSE(Q_of_slip_speed_ratio(-1.0, kDamping));
  EXPECT_FALSE(Q_of_slip_speed_ratio(std::nan(""), kDamping));
  EXPECT_FALSE(Q_of_slip_speed_ratio(std::numeric_limits<double>::infinity(), kDamping));
  // As the ratio comes close to 1 without damping, Q grows and with it the condition number.
  double before = 0.0;
  for (const double off : {1e-1, 1e-3, 1e-6, 1e-9}) {
    const auto found = Q_of_slip_speed_ratio(1.0 + off, 0.0);
    ASSERT_TRUE(found) << off;
    EXPECT_NEAR(found->Q * std::sqrt(2.0 * off), 1.0, off + 1e-6) << off;  // 1 + 1/(2 Q²)
    EXPECT_GT(found->condition, before);
    before = found->condition;
  }
  // A period shorter than that at the threshold, and damping that no formula is made for.
  EXPECT_FALSE(Q_of_period(0.9 * *period_phase_rad(0.999 * Q_threshold(kDamping), kDamping), kDamping));
  EXPECT_FALSE(Q_of_period(10.0, -1e-3));
  EXPECT_FALSE(Q_of_amplitude(2.0, 1.5));
  EXPECT_FALSE(period_phase_rad(1.01 * Q_threshold(kDamping), kDamping));
  EXPECT_FALSE(cycle_mean_excess(1.01 * Q_threshold(kDamping), kDamping));
}

TEST(Inversion, PeriodIsThatOfEquations3And4) {
  for (const double Q : {0.01, 0.327249, 1.308997, 50.0}) {
    EXPECT_NEAR(*period_phase_rad(Q, 0.0), undamped_stick_phase_rad(Q) + undamped_slip_phase_rad(Q),
                1e-13 * *period_phase_rad(Q, 0.0));
  }
}

TEST(Inversion, MeanExceedsKByTheDamping) {
  // Against the sum over a cycle of the closed course, 2 · 10⁵ trapezia: their error is that of one kink,
  // h²/12 times the jump of the slope, 0.3 · 10⁻¹⁰ of S − K and less.
  for (const double part : {0.1, 0.5, 0.68, 0.99}) {
    const double Q = part * Q_threshold(kDamping);
    const double omega = 125.0;
    const double D = 0.05;
    const auto course =
        UniformTrajectory::make({{omega, 2.0 * kDamping * omega, Q * omega * D}, {0.0, D, 0.0}});
    ASSERT_TRUE(course);
    constexpr int kSteps = 200'000;
    double sum = 0.0;
    for (int k = 0; k < kSteps; ++k) sum += course->at(course->period_s() * (k + 0.5) / kSteps).value;
    EXPECT_NEAR(*cycle_mean_excess(Q, kDamping), sum / kSteps / D, 1e-9) << part;
  }
  // What the tester of the paper adds between 3 in/min and the threshold at S − K = 0.05.
  EXPECT_NEAR(*cycle_mean_excess(0.3204, kDamping), 0.032, 0.001);
  EXPECT_NEAR(*cycle_mean_excess(0.999 * Q_threshold(kDamping), kDamping), 0.048, 0.03);
  EXPECT_NEAR(*cycle_mean_excess(0.7, 0.0), 0.0, 1e-14);  // [1]
}

}  // namespace
}  // namespace stickslip::model
