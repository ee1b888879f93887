// Courses of the belt and of K, and friction that depends on speed: against what algebra says.
#include <gtest/gtest.h>

#include <cmath>

#include "core/model/slip_waveform.hpp"
#include "core/sim/bounded_rise.hpp"
#include "core/sim/numeric_solver.hpp"
#include "tests/numeric/constants.hpp"
#include "tests/numeric/motion_recorder.hpp"

namespace stickslip::numeric {
namespace {

constexpr double kAccuracy = 1e-9;

std::vector<double> numeric_trace(const sim::Motion& motion, std::size_t count, double accuracy = kAccuracy) {
  sim::NumericSolver sled{motion, kRate_Hz, accuracy};
  std::vector<double> coefficient(count);
  sled.next(coefficient);
  return coefficient;
}

MotionRecorder recorded(const sim::Motion& motion, double duration_s) {
  MotionRecorder recorder{kRate_Hz};
  sim::NumericSolver sled{motion, kRate_Hz, kAccuracy, &recorder};
  sled.skip(static_cast<std::int64_t>(duration_s * kRate_Hz));
  return recorder;
}

/// c″ of a sled on its coupling is −ω₀² (c − K − κV) − γ c′ with V = v − c′ g/ω₀²: the same as with
/// γ + κg for γ and K + κv for K.
sim::Motion equivalent(const sim::Motion& motion, double per_speed) {
  sim::Motion same = motion;
  const double omega0_squared = motion.oscillator.omega0_squared();
  same.velocity_dependence.reset();
  same.oscillator =
      model::Oscillator::from_omega0(omega0_squared, motion.oscillator.gamma_per_s + per_speed * kGravity);
  same.mu_k += per_speed * motion.belt[0].speed_m_per_s;
  return same;
}

TEST(NumericSolverLaws, LinearVelocityDependenceIsDampingAndAnotherK) {
  for (const double per_speed : {0.1, 0.5, -0.3}) {
    for (const double Q : {1.0, 3.0}) {
      sim::Motion motion = motion_at(Q, 0.022);
      motion.belt[0].duration_s = 2.0;
      motion.velocity_dependence = sim::VelocityDependence{per_speed};
      const sim::Motion same = equivalent(motion, per_speed);
      const std::vector<double> expected = trace(same, kRate_Hz, 700);
      const std::vector<double> numeric = numeric_trace(motion, 700);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        ASSERT_NEAR(numeric[i], expected[i], kAccuracy) << per_speed << ' ' << Q << ' ' << i;
      }
    }
  }
}

// γ + κg < 0: the slip is an oscillation that grows, and so it always comes back to the belt's speed.
TEST(NumericSolverLaws, SteepWeakeningGrowsAtTheRateOfItsNegativeDamping) {
  sim::Motion motion = motion_at(5.0, 0.022);  // Far above the threshold without weakening.
  motion.mu_s = 0.9;
  motion.mu_k = 0.85;
  const double per_speed = -2.0;
  motion.velocity_dependence = sim::VelocityDependence{per_speed};
  motion.belt[0].duration_s = 2.0;
  const double r = motion.oscillator.stick_rate_per_s(motion.belt[0].speed_m_per_s, kGravity);
  const double gamma = motion.oscillator.gamma_per_s + per_speed * kGravity;
  ASSERT_LT(gamma, 0.0);
  const double K = motion.mu_k + per_speed * motion.belt[0].speed_m_per_s;
  const double omega = std::sqrt(motion.oscillator.omega0_squared() - gamma * gamma / 4.0);
  const MotionRecorder recorder = recorded(motion, 2.0);
  ASSERT_GE(recorder.onsets_s.size(), 5U);
  // The first slip, from (S, r) on.
  const double onset_s = recorder.onsets_s[0];
  const double D = motion.mu_s - K;
  sim::NumericSolver sled{motion, kRate_Hz, kAccuracy};
  double capture_s = 0.0;
  for (const double captured_s : recorder.captures_s) {
    if (captured_s > onset_s && capture_s == 0.0) capture_s = captured_s;
  }
  for (std::int64_t scan = static_cast<std::int64_t>(onset_s * kRate_Hz) + 1;
       static_cast<double>(scan) < capture_s * kRate_Hz; ++scan) {
    const double t = static_cast<double>(scan) / kRate_Hz - onset_s;
    const double expected =
        K + std::exp(-gamma * t / 2.0) *
                (D * std::cos(omega * t) + (r + gamma * D / 2.0) / omega * std::sin(omega * t));
    ASSERT_NEAR(sled.at({scan, 0.0}), expected, kAccuracy) << scan;
  }
  const double t = capture_s - onset_s;
  const double rate = std::exp(-gamma * t / 2.0) *
                      (r * std::cos(omega * t) - (gamma * r / 2.0 + motion.oscillator.omega0_squared() * D) /
                                                     omega * std::sin(omega * t));
  EXPECT_NEAR(rate / r, 1.0, 1e-6);
}

// K(V) at the belt's speed is what the force of a steady slide settles at.
TEST(NumericSolverLaws, SteadySlidingReadsTheStribeckCurve) {
  for (const double exponent : {0.7, 1.0, 2.0}) {
    sim::Motion motion = motion_at(6.0, 0.4);
    const double speed = motion.belt[0].speed_m_per_s;
    motion.velocity_dependence = sim::VelocityDependence{0.1, 0.03, 2.0 * speed, exponent};
    motion.belt[0].duration_s = 4.0;
    const double expected = motion.mu_k + 0.1 * speed + 0.03 * std::exp(-std::pow(0.5, exponent));
    EXPECT_NEAR(numeric_trace(motion, 1400).back(), expected, kAccuracy) << exponent;
  }
}

// Until the first slip c = ∫ r: a quadratic, a cubic, an exponential start.
TEST(NumericSolverLaws, StickingFollowsTheTravelOfTheBelt) {
  const double factor = motion_at(1.0, 0.022).oscillator.omega0_squared() / kGravity;
  const auto first_scans = [](sim::BeltSegment segment) {
    sim::Motion motion = motion_at(1.0, 0.022);
    motion.belt = {segment};
    return numeric_trace(motion, 30);
  };
  const auto seconds = [](std::size_t scan) { return static_cast<double>(scan) / kRate_Hz; };
  const std::vector<double> ramp = first_scans({.duration_s = 1.0, .acceleration_m_per_s2 = 0.02});
  const std::vector<double> jerk = first_scans({.duration_s = 1.0, .jerk_m_per_s3 = 0.5});
  const std::vector<double> start = first_scans(
      {.duration_s = 1.0, .speed_m_per_s = 0.002, .decaying_speed_m_per_s = -0.002, .time_constant_s = 0.05});
  for (std::size_t i = 0; i < ramp.size(); ++i) {
    const double t = seconds(i);
    ASSERT_NEAR(ramp[i], factor * 0.02 * t * t / 2.0, 1e-14);
    ASSERT_NEAR(jerk[i], factor * 0.5 * t * t * t / 6.0, 1e-14);
    ASSERT_NEAR(start[i], factor * 0.002 * (t + 0.05 * std::expm1(-t / 0.05)), 1e-14);
  }
}

// A one-way coupling that is just taut when the belt starts with a jerk: neither its force nor the slope of
// the force nor its curvature tells yet that it does not go slack.
TEST(NumericSolverLaws, AJerkFromRestKeepsAOneWayCouplingTaut) {
  sim::Motion motion = motion_at(1.0, 0.022);
  motion.one_way_coupling = true;
  motion.belt = {{.duration_s = 0.01}, {.duration_s = 1.0, .jerk_m_per_s3 = 0.5}};
  const double factor = motion.oscillator.omega0_squared() / kGravity;
  const std::vector<double> started = numeric_trace(motion, 30);
  for (std::size_t i = 0; i < started.size(); ++i) {
    const double t = std::max(static_cast<double>(i) / kRate_Hz - 0.01, 0.0);
    ASSERT_NEAR(started[i], factor * 0.5 * t * t * t / 6.0, 1e-14);
  }
}

// Friction has to supply the acceleration of the sled too: it gives way when c + a/g = S.
TEST(NumericSolverLaws, AnAcceleratingBeltLosesTheSledSooner) {
  sim::Motion motion = motion_at(1.0, 0.022);
  const double a = 0.5;
  motion.belt = {{.duration_s = 5.0, .acceleration_m_per_s2 = a}};
  const MotionRecorder recorder = recorded(motion, 1.0);
  const double factor = motion.oscillator.omega0_squared() / kGravity;
  ASSERT_FALSE(recorder.onsets_s.empty());
  EXPECT_NEAR(recorder.onsets_s[0], std::sqrt(2.0 * (motion.mu_s - a / kGravity) / (factor * a)), 1e-12);
}

// Faster than friction can follow, up or down: the sled slides at once; braked, it overtakes the belt.
TEST(NumericSolverLaws, ABeltThatAcceleratesBeyondFrictionNeverTakesTheSledAlong) {
  sim::Motion motion = motion_at(1.0, 0.022);
  motion.belt = {{.duration_s = 0.05, .acceleration_m_per_s2 = 10.0}};
  EXPECT_FALSE(recorded(motion, 0.04).onsets_s.empty());
  motion.belt = {{0.02, 0.002}, {.duration_s = 0.01, .speed_m_per_s = 0.002, .acceleration_m_per_s2 = -10.0}};
  const MotionRecorder braked = recorded(motion, 0.025);
  ASSERT_FALSE(braked.onsets_s.empty());
  EXPECT_NEAR(braked.onsets_s.back(), 0.02, 1e-12);
}

// S(t) = S + (f − 1) K falls on the sled that rests with the coupling stretched.
TEST(NumericSolverLaws, DriftOfKLetsARestingSledGo) {
  using Drift = sim::KineticDrift;
  sim::Motion motion = motion_at(1.0, 0.022);
  const double factor = motion.oscillator.omega0_squared() / kGravity;
  const auto seconds = [](double s) { return sim::ScanTime{}.later(s * kRate_Hz); };
  motion.belt = {{1.0, 0.30 / factor}};  // A slow pull, to about 0.30 in a second; then at rest.
  motion.kinetic_drift = Drift{Drift::Form::kLinear, Drift::Over::kTime, -0.1, 1.0};
  // Where it rests: the sled has slid a little before it followed the belt.
  const double held = sim::NumericSolver(motion, kRate_Hz, kAccuracy).at(seconds(1.1));
  // 0.35 − 0.1 t · 0.30 = held; roundings of c over the slope of S, 0.03/s.
  EXPECT_NEAR(recorded(motion, 3.0).onsets_s.at(0), (0.35 - held) / 0.03, 1e-12);
  motion.kinetic_drift = Drift{Drift::Form::kExponential, Drift::Over::kTime, -0.2, 2.0};
  // 0.35 − 0.2 (1 − e^(−t/2)) · 0.30 = held
  const double also = sim::NumericSolver(motion, kRate_Hz, kAccuracy).at(seconds(1.1));
  EXPECT_NEAR(recorded(motion, 9.0).onsets_s.at(0), -2.0 * std::log1p(-(0.35 - also) / 0.06), 1e-10);
}

// A slide at constant speed reads K f, but for the inertia of so slow a change.
TEST(NumericSolverLaws, SteadySlidingFollowsTheDrift) {
  using Drift = sim::KineticDrift;
  sim::Motion motion = motion_at(6.0, 0.4);
  motion.belt[0].duration_s = 10.0;
  const double travel_m = motion.belt[0].speed_m_per_s * 10.0;
  for (const Drift::Over over : {Drift::Over::kTime, Drift::Over::kBeltTravel}) {
    const double scale = over == Drift::Over::kTime ? 10.0 : travel_m;
    motion.kinetic_drift = Drift{Drift::Form::kLinear, over, -0.5, scale};
    const double end = numeric_trace(motion, 3501, 1e-6).back();
    // K f − (γ/ω₀²) d(K f)/dt
    const double lag = motion.oscillator.gamma_per_s / motion.oscillator.omega0_squared() * 0.015;
    EXPECT_NEAR(end, 0.15 + lag, 1e-6);
  }
}

// l = −slack + ∫v: a sled that is slack from the start has been riding on the belt, and the force starts
// when the slack is gone; as by the exact solver.
TEST(NumericSolverLaws, StartUpSlackDelaysTheForce) {
  sim::Motion motion = motion_at(1.0, 0.022);
  motion.one_way_coupling = true;
  motion.startup_slack_m = 0.001;
  motion.belt = {{2.0, 0.01}};
  sim::NumericSolver sled{motion, kRate_Hz, kAccuracy};
  EXPECT_EQ(sled.at({static_cast<std::int64_t>(0.099 * kRate_Hz), 0.0}), 0.0);
  const double taut_s = 0.001 / 0.01;
  const double factor = motion.oscillator.omega0_squared() / kGravity;
  const sim::ScanTime instant{40, 0.0};
  EXPECT_NEAR(sled.at(instant), factor * 0.01 * (40.0 / kRate_Hz - taut_s), kAccuracy);
}

/// 1 − (t − 1)²/w² − 1: touches zero from below at t = 1, or rises above it by `excess`.
struct Hill {
  double excess;
  [[nodiscard]] double value(double t) const { return excess - (t - 1.0) * (t - 1.0); }
  [[nodiscard]] double slope(double t) const { return -2.0 * (t - 1.0); }
  [[nodiscard]] double bend(double /*from*/, double /*to*/) const { return 3.0; }  // Far from sharp.
};

TEST(BoundedRise, FindsAHillHoweverLowAndPassesUnderNone) {
  for (const double excess : {0.1, 1e-4, 1e-8, 1e-12}) {
    const auto t = sim::bounded_rise_s(Hill{excess}, 1e9, 0.3, 1e-17);
    ASSERT_TRUE(t) << excess;
    EXPECT_NEAR(*t, 1.0 - std::sqrt(excess), 1e-15 / std::sqrt(excess) + 1e-14);
    EXPECT_FALSE(sim::bounded_rise_s(Hill{-excess}, 1e9, 0.3, 1e-17)) << excess;
  }
}

}  // namespace
}  // namespace stickslip::numeric
