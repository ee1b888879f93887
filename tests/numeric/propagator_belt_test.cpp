// Belts that change their speed, K that drifts, a coupling that is slack at first: where there is a closed
// result.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/model/threshold.hpp"
#include "tests/numeric/constants.hpp"
#include "tests/numeric/motion_recorder.hpp"

namespace stickslip::numeric {
namespace {

using model::Mode;
using sim::BeltSegment;
using sim::KineticDrift;

TEST(KineticDrift, HasNoClosedFormInResonance) {
  sim::Motion motion = on_belt({{.duration_s = 2.0, .speed_m_per_s = kSpeed}});
  motion.oscillator = model::Oscillator::from_omega0(4.0, 5.0);  // Decays with 1/s and 4/s.
  motion.kinetic_drift = KineticDrift{KineticDrift::Form::kExponential, KineticDrift::Over::kTime, 0.5, 1.0};
  EXPECT_FALSE(has_closed_form(motion));
  motion.kinetic_drift->scale = 0.5;
  EXPECT_TRUE(has_closed_form(motion));
}

/// Far above the threshold and long after the start the sled slides steadily.
double after_ringing_down(const KineticDrift& drift, double at_s) {
  sim::Motion motion = motion_at(10.0, 0.022);
  motion.kinetic_drift = drift;
  sim::Propagator sled{motion, 350.0};
  return sled.at({static_cast<std::int64_t>(at_s * 350.0), 0.0});
}

// c = K(t) − γK′/ω₀² solves c″ + γc′ + ω₀²c = ω₀²K exactly while K is a line. The oscillation is down to
// e^(−0.022 ω · 20) = 1e-24.
TEST(KineticDrift, SteadySlidingLagsBehindALineByTheDampersShare) {
  const model::Oscillator oscillator = motion_at(1.0, 0.022).oscillator;
  for (const double change : {-0.3, 0.5}) {
    const double slope_per_s = 0.30 * change / 40.0;
    const double expected =
        0.30 + slope_per_s * 20.0 - oscillator.gamma_per_s * slope_per_s / oscillator.omega0_squared();
    EXPECT_NEAR(
        after_ringing_down({KineticDrift::Form::kLinear, KineticDrift::Over::kTime, change, 40.0}, 20.0),
        expected, 8.0 * kEpsilon);
  }
}

// c = K∞ + B e^(−λt) with B = −K change ω₀²/(λ² − γλ + ω₀²).
TEST(KineticDrift, SteadySlidingFollowsAnExponential) {
  const model::Oscillator oscillator = motion_at(1.0, 0.022).oscillator;
  const double lambda = 1.0 / 10.0;
  const double part = oscillator.omega0_squared() /
                      (lambda * lambda - oscillator.gamma_per_s * lambda + oscillator.omega0_squared());
  const double expected = 0.30 * (1.0 - 0.4) + 0.30 * 0.4 * part * std::exp(-2.0);
  EXPECT_NEAR(
      after_ringing_down({KineticDrift::Form::kExponential, KineticDrift::Over::kTime, -0.4, 10.0}, 20.0),
      expected, 8.0 * kEpsilon);
}

// S − K stays: each onset is at the K of its moment plus 0.05.
TEST(KineticDrift, OnsetsTellSAndKOfTheirMoment) {
  sim::Motion motion = motion_at(0.5, 0.022);
  motion.kinetic_drift = KineticDrift{KineticDrift::Form::kLinear, KineticDrift::Over::kTime, 0.5, 10.0};
  MotionRecorder recorder{350.0};
  sim::Propagator sled{motion, 350.0, &recorder};
  sled.skip(3500);
  int onsets = 0;
  for (const sim::ModeStart& start : recorder.starts) {
    const double K = 0.30 * (1.0 + 0.05 * start.time.periods_since({}) / 350.0);
    EXPECT_NEAR(start.paper.mu_k, K, 4.0 * kEpsilon);
    EXPECT_NEAR(start.paper.mu_s, K + 0.05, 4.0 * kEpsilon);
    if (!start.onset) continue;
    EXPECT_EQ(start.coefficient, start.paper.mu_s);
    ++onsets;
  }
  EXPECT_GT(onsets, 50);
}

TEST(StartUpSlack, IsTakenUpByTheBeltAlone) {
  for (const double speed : {1e-6, kSpeed, 1.0}) {
    for (const double slack_m : {1e-9, 1e-3, 1.0}) {
      sim::Motion motion = on_belt({{.duration_s = 1e9, .speed_m_per_s = speed}}, 0.022, true);
      motion.startup_slack_m = slack_m;
      MotionRecorder recorder{350.0};
      sim::Propagator sled{motion, 350.0, &recorder};
      sled.skip(static_cast<std::int64_t>(350.0 * slack_m / speed) + 350);
      const auto taut = std::find_if(recorder.starts.begin(), recorder.starts.end(),
                                     [](const sim::ModeStart& start) { return start.mode != Mode::kSlack; });
      ASSERT_NE(taut, recorder.starts.end());
      // A quotient of two products, in scans.
      EXPECT_NEAR(taut->time.periods_since({}) / (350.0 * slack_m / speed), 1.0, 6.0 * kEpsilon);
      EXPECT_EQ(taut->mode, Mode::kStick);
      EXPECT_EQ(taut->coefficient, 0.0);
      EXPECT_LT(recorder.starts.size(), 100U);
    }
  }
}

TEST(StartUpSlack, ComesBackAtEachRestart) {
  sim::Motion motion =
      on_belt({{.duration_s = 0.1}, {.duration_s = 5.0, .speed_m_per_s = kSpeed}}, 0.022, true);
  motion.startup_slack_m = 1e-3;
  sim::Propagator sled{motion, 350.0};
  std::vector<double> first(1000);
  std::vector<double> second(1000);
  sled.next(first);
  sled.restart(1);
  sled.next(second);
  EXPECT_EQ(first, second);
  // Taut after 0.1 s and 1 mm/v = 0.197 s: 103.9 scans, and the way that the sled needs to catch up with the
  // belt.
  EXPECT_EQ(first[103], 0.0);
  EXPECT_GT(first[108], 0.0);
}

// c = ω₀² a t²/2g and q = c + a/g: slip starts when q = S, at t = √(2(S − a/g) g/(ω₀² a)).
TEST(SpeedRamp, FromRestGivesWayWhereForceAndInertiaAddUpToS) {
  for (const double acceleration : {1e-9, 1e-6, 1e-3, 0.1, 1.0, 3.0}) {
    sim::Motion motion = on_belt({{.duration_s = 1e9, .acceleration_m_per_s2 = acceleration}});
    MotionRecorder recorder{350.0};
    sim::Propagator sled{motion, 350.0, &recorder};
    const double share = acceleration / kGravity;
    const double expected_s =
        std::sqrt(2.0 * (0.35 - share) * kGravity / (motion.oscillator.omega0_squared() * acceleration));
    sled.skip(static_cast<std::int64_t>(350.0 * expected_s) + 2);
    ASSERT_GE(recorder.onsets_s.size(), 1U) << acceleration;
    EXPECT_NEAR(recorder.onsets_s[0] / expected_s, 1.0, 8.0 * kEpsilon) << acceleration;
    const auto onset = std::find_if(recorder.starts.begin(), recorder.starts.end(),
                                    [](const sim::ModeStart& start) { return start.onset; });
    EXPECT_NEAR(onset->coefficient, 0.35 - share, 2.0 * kEpsilon);
  }
}

// q > 1 at 10 m/s²: the sled never follows such a belt, forwards or backwards; and braking so hard it is
// overtaken by the sled, which friction −K then slows.
TEST(SpeedRamp, HarderThanFrictionIsNeverFollowed) {
  for (const double acceleration : {10.0, -10.0}) {
    sim::Motion motion = on_belt({{.duration_s = 10.0, .acceleration_m_per_s2 = acceleration}});
    MotionRecorder recorder{350.0};
    sim::Propagator sled{motion, 350.0, &recorder};
    sled.skip(3500);
    for (const sim::ModeStart& start : recorder.starts) {
      if (start.time > sim::ScanTime{0, 0.0} && start.time < sim::ScanTime{3500, 0.0}) {
        EXPECT_NE(start.mode, Mode::kStick);
      }
    }
  }
}

// A millionth of a mm/s² is a constant belt; up and down are each other's image in the first order.
TEST(SpeedRamp, TheFaintestIsAConstantBelt) {
  sim::Motion motion = motion_at(1.0, 0.022);
  const std::vector<double> constant = trace(motion, 350.0, 3500);
  for (const double acceleration : {1e-9, -1e-9}) {
    motion.belt[0].duration_s = 100.0;
    motion.belt[0].acceleration_m_per_s2 = acceleration;
    const std::vector<double> ramp = trace(motion, 350.0, 3500);
    // After 10 s the belt is 5e-8 m off: 8e-5 of the coefficient's unit, and the cycles' phase with it.
    const double off = 16e3 / kGravity * 1e-9 * 50.0 * 10.0;
    for (std::size_t i = 0; i < ramp.size(); ++i) ASSERT_NEAR(ramp[i], constant[i], off) << i;
    EXPECT_NE(ramp.back(), constant.back());
  }
}

// Up through the threshold the oscillation ends, once for all: the last capture is at a speed below v_th, and
// the first slip that is not captured begins above it. Down again nothing starts, until the belt is so slow
// that the slope of the speed stops the sled.
TEST(SpeedRamp, ThroughTheThresholdUpAndDownShowsHysteresis) {
  const double damping = 0.022;
  const double Q_th = model::Q_threshold(damping);
  sim::Motion motion = motion_at(Q_th, damping);
  const double v_th = motion.belt[0].speed_m_per_s;
  const double acceleration = v_th / 100.0;  // Per second: 5e-4 of v_th in a cycle.
  motion.belt = {{.duration_s = 60.0, .speed_m_per_s = 0.7 * v_th, .acceleration_m_per_s2 = acceleration},
                 {.duration_s = 100.0, .speed_m_per_s = 1.3 * v_th, .acceleration_m_per_s2 = -acceleration}};
  MotionRecorder recorder{350.0};
  sim::Propagator sled{motion, 350.0, &recorder};
  sled.skip(350 * 160);
  const double last_capture_s = recorder.captures_s.back();
  const double last_onset_s = recorder.onsets_s.back();
  const double threshold_s = 30.0;
  // While a slip lasts, the belt gains 5e-4 of its speed, which makes capture harder: the end comes early by
  // as much, and a cycle is 0.05 s.
  EXPECT_NEAR(last_onset_s, threshold_s, 0.3);
  EXPECT_LT(last_capture_s, last_onset_s);
  EXPECT_GT(recorder.onsets_s.size(), 300U);
}

// Hard case 5 on a ramp with drift: γ through 2ω₀.
TEST(SpeedRamp, DampingThroughCriticalJoinsWithoutAJump) {
  const auto at = [](double ratio) {
    sim::Motion motion =
        on_belt({{.duration_s = 0.3, .acceleration_m_per_s2 = 0.02},
                 {.duration_s = 3.0, .speed_m_per_s = 0.006, .acceleration_m_per_s2 = -0.001}});
    motion.oscillator = model::Oscillator::from_omega0(kOmega * kOmega, 2.0 * kOmega * ratio);
    motion.kinetic_drift =
        KineticDrift{KineticDrift::Form::kExponential, KineticDrift::Over::kTime, 0.5, 2.0};
    return trace(motion, 350.0, 1200);
  };
  const std::vector<double> critical = at(1.0);
  for (const double off : {1e-4, 1e-8, 1e-12, 1e-15}) {
    for (const double sign : {1.0, -1.0}) {
      const std::vector<double> near = at(1.0 + sign * off);
      // dc/d(ratio) is of the order of c itself; event times round besides.
      for (std::size_t i = 0; i < near.size(); ++i)
        ASSERT_NEAR(near[i], critical[i], 2.0 * off + 1e-13) << off;
    }
  }
}

// S = K = 0: the damper alone would hold the sled at the belt's speed against its spring.
TEST(SpeedRamp, WithoutFrictionTheSledHangsOnItsCoupling) {
  sim::Motion motion =
      on_belt({{.duration_s = 10.0, .speed_m_per_s = 0.01, .acceleration_m_per_s2 = -0.004}});
  motion.mu_s = motion.mu_k = 0.0;
  for (const double c : trace(motion, 350.0, 3500)) ASSERT_EQ(c, 0.0);
}

TEST(SpeedProfiles, BackwardsIsTheMirrorImage) {
  sim::Motion motion = on_belt(
      {{.duration_s = 0.5, .acceleration_m_per_s2 = 0.02},
       {.duration_s = 1.0, .speed_m_per_s = 0.01, .decaying_speed_m_per_s = -0.004, .time_constant_s = 0.1},
       {.duration_s = 3.0, .speed_m_per_s = 0.006, .jerk_m_per_s3 = -0.002}});
  motion.kinetic_drift = KineticDrift{KineticDrift::Form::kExponential, KineticDrift::Over::kTime, 0.5, 2.0};
  const std::vector<double> forwards = trace(motion, 350.0, 2000);
  for (BeltSegment& segment : motion.belt) {
    segment.speed_m_per_s *= -1.0;
    segment.acceleration_m_per_s2 *= -1.0;
    segment.jerk_m_per_s3 *= -1.0;
    segment.decaying_speed_m_per_s *= -1.0;
  }
  const std::vector<double> backwards = trace(motion, 350.0, 2000);
  for (std::size_t i = 0; i < forwards.size(); ++i) ASSERT_EQ(forwards[i], -backwards[i]) << i;
}

// One belt, cut into pieces that join smoothly, with the roundings of their joints.
TEST(SpeedProfiles, CutsMakeNoDifference) {
  const double acceleration = 0.003;
  const auto whole =
      trace(on_belt({{.duration_s = 4.0, .acceleration_m_per_s2 = acceleration}}), 350.0, 1400);
  std::vector<BeltSegment> pieces;
  for (int i = 0; i < 40; ++i) {
    const double start_s = 0.1 * i;
    pieces.push_back(
        {.duration_s = 0.1, .speed_m_per_s = acceleration * start_s, .acceleration_m_per_s2 = acceleration});
  }
  const auto cut = trace(on_belt(pieces), 350.0, 1400);
  // Each joint moves times by some epsilon of a scan; the slips after it keep that.
  for (std::size_t i = 0; i < whole.size(); ++i) ASSERT_NEAR(whole[i], cut[i], 1e-11) << i;
}

// Ageing on a ramp: the contact gives way at the S of its age, and the force does not jump.
TEST(SpeedRamp, AgeingContactGivesWayAtTheSOfItsAge) {
  for (const double cutoff_s : {1e-9, 1e-4, 1.0}) {
    sim::Motion motion =
        on_belt({{.duration_s = 30.0, .speed_m_per_s = 0.0005, .acceleration_m_per_s2 = 1e-4}});
    motion.paper.contact_ageing = sim::ContactAgeing{0.02, cutoff_s};
    MotionRecorder recorder{350.0};
    sim::Propagator sled{motion, 350.0, &recorder};
    sled.skip(350 * 20);
    ASSERT_GT(recorder.onsets_s.size(), 10U);
    for (std::size_t i = 1; i < recorder.starts.size(); ++i) {
      const sim::ModeStart& onset = recorder.starts[i];
      const sim::ModeStart& before = recorder.starts[i - 1];
      if (!onset.onset || before.mode != Mode::kStick) continue;
      const double rested_s = onset.time.periods_since(before.time) / 350.0;
      EXPECT_NEAR(onset.paper.mu_s, 0.35 + 0.02 * std::log10(1.0 + rested_s / cutoff_s), 1e-13);
      const double share = 1e-4 / kGravity;
      EXPECT_NEAR(onset.coefficient + share, onset.paper.mu_s, 1e-15);
      const double start_s = before.time.periods_since({}) / 350.0;
      const double speed = 0.0005 + 1e-4 * start_s;
      const double stretched_m = speed * rested_s + 0.5e-4 * rested_s * rested_s;
      // Reached by the belt's way within what the snap to the limit may hide.
      EXPECT_NEAR(before.coefficient + motion.oscillator.omega0_squared() / kGravity * stretched_m,
                  onset.coefficient, 1e-12);
    }
  }
}

}  // namespace
}  // namespace stickslip::numeric
