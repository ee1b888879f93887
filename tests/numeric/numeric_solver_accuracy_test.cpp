// The numeric solver against the closed forms, on motions that both can solve.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "core/model/threshold.hpp"
#include "core/sim/cvode.hpp"
#include "core/sim/numeric_solver.hpp"
#include "tests/numeric/constants.hpp"
#include "tests/numeric/motion_recorder.hpp"

namespace stickslip::numeric {
namespace {

constexpr double kDamping = 0.022;
constexpr double kDuration_s = 2.0;

sim::Motion lasting(sim::Motion motion) {
  motion.belt[0].duration_s = kDuration_s;
  return motion;
}

sim::Motion with_slack(double gamma_over_2omega) {
  sim::Motion motion = motion_at(1.5, gamma_over_2omega, 0.35, 0.1);  // S > 2K: always slack.
  motion.one_way_coupling = true;
  return lasting(motion);
}

sim::Motion overdamped() {
  sim::Motion motion = motion_at(1.0, kDamping);
  motion.oscillator = model::Oscillator::from_omega0(kOmega * kOmega, 3.0 * kOmega);
  return lasting(motion);
}

/// The belts and courses of K that both solvers know. A ramp from Q = 1 to 1.5 within the two seconds.
sim::Motion on_a_ramp(double to_part) {
  sim::Motion motion = lasting(motion_at(1.0, kDamping));
  sim::BeltSegment& pull = motion.belt[0];
  pull.acceleration_m_per_s2 = (to_part - 1.0) * pull.speed_m_per_s / kDuration_s;
  return motion;
}

sim::Motion with_slow_motor() {
  sim::Motion motion = lasting(motion_at(1.0, kDamping));
  motion.belt[0].decaying_speed_m_per_s = -motion.belt[0].speed_m_per_s;
  motion.belt[0].time_constant_s = 0.2;
  return motion;
}

sim::Motion taut_later() {
  sim::Motion motion = lasting(motion_at(1.0, kDamping));
  motion.one_way_coupling = true;
  motion.startup_slack_m = 0.3 * motion.belt[0].speed_m_per_s;  // Taut after 0.3 s.
  return motion;
}

/// As a scene without an idle time begins: the sled is at rest when the belt starts.
sim::Motion slack_at_rest() {
  sim::Motion motion = taut_later();
  motion.belt.insert(motion.belt.begin(), sim::BeltSegment{});
  return motion;
}

sim::Motion drifting(sim::KineticDrift::Form course, sim::KineticDrift::Over over) {
  sim::Motion motion = lasting(motion_at(1.0, kDamping));
  const bool in_time = over == sim::KineticDrift::Over::kTime;
  const double scale = in_time ? kDuration_s : kDuration_s * motion.belt[0].speed_m_per_s;
  motion.kinetic_drift = sim::KineticDrift{course, over, -0.2, scale};
  return motion;
}

sim::Motion scattered() {
  sim::Motion motion = lasting(motion_at(0.5, kDamping));
  motion.paper.scatter = sim::Scatter{0.3, 0.002};
  return motion;
}

std::vector<double> scans_of(sim::MotionSolver& sled, double duration_s) {
  std::vector<double> coefficient(static_cast<std::size_t>(duration_s * kRate_Hz));
  sled.next(coefficient);
  return coefficient;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    // Written so that a NaN does not pass.
    if (!(std::abs(a[i] - b[i]) <= largest)) largest = std::abs(a[i] - b[i]);
  }
  return largest;
}

double error_of(const sim::Motion& motion, double accuracy) {
  sim::Propagator exact{motion, kRate_Hz};
  sim::NumericSolver numeric{motion, kRate_Hz, accuracy};
  return largest_difference(scans_of(exact, kDuration_s), scans_of(numeric, kDuration_s));
}

struct Case {
  std::string name;
  sim::Motion motion;
};

class NumericSolverAccuracy : public ::testing::TestWithParam<Case> {};

TEST_P(NumericSolverAccuracy, IsWhatWasAskedFor) {
  for (int digits = 3; digits <= 10; ++digits) {
    const double accuracy = std::pow(10.0, -digits);
    const sim::NumericSolver sled{GetParam().motion, kRate_Hz, accuracy};
    EXPECT_EQ(sled.method().accuracy, accuracy);
    EXPECT_LE(error_of(GetParam().motion, accuracy), accuracy) << digits;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Motions, NumericSolverAccuracy,
    ::testing::Values(
        Case{"sticking", lasting(motion_at(1.0, kDamping))}, Case{"undamped", lasting(motion_at(1.3, 0.0))},
        Case{"ring_down", lasting(motion_at(2.5, kDamping))},
        Case{"below_threshold", lasting(motion_at(0.9 * model::Q_threshold(kDamping), kDamping))},
        Case{"above_threshold", lasting(motion_at(1.1 * model::Q_threshold(kDamping), kDamping))},
        Case{"slack", with_slack(kDamping)}, Case{"undamped_slack", with_slack(0.0)},
        Case{"overdamped", overdamped()}, Case{"ramp_up", on_a_ramp(1.5)}, Case{"ramp_down", on_a_ramp(0.3)},
        Case{"slow_motor", with_slow_motor()}, Case{"startup_slack", taut_later()},
        Case{"startup_slack_at_rest", slack_at_rest()},
        Case{"linear_drift", drifting(sim::KineticDrift::Form::kLinear, sim::KineticDrift::Over::kTime)},
        Case{"exponential_drift_over_travel",
             drifting(sim::KineticDrift::Form::kExponential, sim::KineticDrift::Over::kBeltTravel)},
        Case{"scattered", scattered()}),
    [](const auto& one) { return one.param.name; });

TEST(NumericSolver, SaysWhatItCannotReach) {
  sim::Motion motion = motion_at(1.0, kDamping);
  motion.belt[0].duration_s = 1e6;  // Twenty million cycles.
  const sim::NumericSolver sled{motion, kRate_Hz, 1e-12};
  EXPECT_GT(sled.method().accuracy, 1e-9);
  EXPECT_EQ(sled.method().name, "SUNDIALS CVODE (Adams)");
  EXPECT_EQ(sim::NumericSolver(overdamped(), kRate_Hz, 1e-6).method().name, "SUNDIALS CVODE (BDF)");
}

// A method of order q that controls the error of each step by the tolerance has a global error that goes
// as tolerance^(q/(q+1)); Adams' method works at 5 ≤ q ≤ 12 here: 0.83 … 0.92. Step sizes are chosen in
// jumps, which scatter the error by a factor of three: over seven decades ± 0.07.
TEST(NumericSolver, ErrorFallsWithTheTolerance) {
  const sim::Motion motion = lasting(motion_at(2.5, kDamping));
  const double slope = std::log10(error_of(motion, 1e-3) / error_of(motion, 1e-10)) / 7.0;
  EXPECT_GT(slope, 0.76);
  EXPECT_LT(slope, 1.07);
}

int captures_after_onset(double Q, double accuracy) {
  sim::Motion motion = motion_at(Q, kDamping, 2.05, 2.0);  // K = 2: takes the sled along at once.
  motion.belt[0].duration_s = kDuration_s;
  MotionRecorder recorder{kRate_Hz};
  sim::NumericSolver sled{motion, kRate_Hz, accuracy, &recorder};
  sled.skip(static_cast<std::int64_t>(kDuration_s * kRate_Hz));
  EXPECT_FALSE(recorder.onsets_s.empty());
  const double first_s = recorder.onsets_s.empty() ? 0.0 : recorder.onsets_s.front();
  return static_cast<int>(std::count_if(recorder.captures_s.begin(), recorder.captures_s.end(),
                                        [first_s](double capture_s) { return capture_s > first_s; }));
}

// At Q_th(1 − δ) the highest c′ of the slip is above r by about δ r, inside a step, with c′ below r at both
// of its ends. The solver's c is right to the accuracy A, c′/r to A ω/r = A/(Q (S − K)) ≈ 10 A: it can tell
// the sides apart as long as δ ≥ 100 A.
TEST(NumericSolver, TakesTheRightSideOfTheThreshold) {
  const double Q_th = model::Q_threshold(kDamping);
  for (int n = 2; n <= 8; ++n) {
    const double delta = std::pow(10.0, -n);
    const double accuracy = 0.01 * delta;
    EXPECT_GE(captures_after_onset(Q_th * (1.0 - delta), accuracy), 10) << n;
    EXPECT_EQ(captures_after_onset(Q_th * (1.0 + delta), accuracy), 0) << n;
  }
}

TEST(NumericSolver, GivesTheSameScansHoweverTheyAreAskedFor) {
  const sim::Motion motion = lasting(motion_at(1.0, kDamping));
  sim::NumericSolver whole{motion, kRate_Hz, 1e-6};
  const std::vector<double> expected = scans_of(whole, kDuration_s);
  sim::NumericSolver pieces{motion, kRate_Hz, 1e-6};
  std::vector<double> scans(expected.size());
  for (std::size_t at = 0, count = 1; at < scans.size(); at += count, count = count % 7 + 1) {
    count = std::min(count, scans.size() - at);
    pieces.next(std::span{scans}.subspan(at, count));
  }
  EXPECT_EQ(scans, expected);
  whole.restart(1);
  whole.skip(100);
  EXPECT_EQ(whole.at({100, 0.0}), expected[100]);
  EXPECT_EQ(scans_of(whole, 1.0).front(), expected[100]);
}

TEST(NumericSolver, SplittingThePullChangesNothing) {
  sim::Motion motion = lasting(motion_at(1.0, kDamping));
  sim::NumericSolver whole{motion, kRate_Hz, 1e-9};
  const std::vector<double> expected = scans_of(whole, kDuration_s);
  const double speed = motion.belt[0].speed_m_per_s;
  motion.belt = {{0.3, speed}, {0.7123, speed}, {kDuration_s - 1.0123, speed}};
  sim::NumericSolver parts{motion, kRate_Hz, 1e-9};
  EXPECT_LE(largest_difference(scans_of(parts, kDuration_s), expected), 2e-9);  // Both have their error.
}

TEST(NumericSolver, StartingLaterOnlyShiftsTheScans) {
  sim::Motion motion = lasting(motion_at(1.0, kDamping));
  sim::NumericSolver now{motion, kRate_Hz, 1e-9};
  const std::vector<double> expected = scans_of(now, kDuration_s);
  constexpr std::int64_t kLater = 1'000'000'000;  // A month of scans
  motion.belt.insert(motion.belt.begin(), {static_cast<double>(kLater) / kRate_Hz, 0.0});
  // The rest before the pull makes cycles in the solver's count, though none in the motion: it is asked
  // for less, and would deliver more.
  sim::NumericSolver later{motion, kRate_Hz, 1e-3};
  later.skip(kLater);
  EXPECT_LE(largest_difference(scans_of(later, kDuration_s), expected), 2e-3);
}

// ω₀ → 2ω₀, scan rate → twice, v → v/2: the same coefficients at the same scans.
TEST(NumericSolver, ScalesWithTheStiffness) {
  const sim::Motion motion = lasting(motion_at(1.0, kDamping));
  sim::NumericSolver soft{motion, kRate_Hz, 1e-9};
  sim::Motion stiff = motion;
  stiff.oscillator = model::Oscillator::from_omega(2.0 * kOmega, kDamping);
  stiff.belt = {{motion.belt[0].duration_s / 2.0, motion.belt[0].speed_m_per_s / 2.0}};
  sim::NumericSolver fast{stiff, 2.0 * kRate_Hz, 1e-9};
  EXPECT_LE(largest_difference(scans_of(fast, kDuration_s), scans_of(soft, kDuration_s)), 2e-9);
}

// What a follower is shown joins up and ends where the motion is.
TEST(NumericSolver, ShowsTheForceWithoutAHole) {
  class Follower final : public sim::ForceFollower {
   public:
    void follow(const sim::ForceStretch& s) override {
      if (duration_s > 0.0) largest_jump = std::max(largest_jump, std::abs(s.course.value(0.0) - end));
      duration_s += s.duration_s;
      end = s.course.value(s.duration_s);
    }
    double duration_s = 0.0;
    double end = 0.0;
    double largest_jump = 0.0;
  };
  sim::Motion motion = with_slack(kDamping);
  sim::NumericSolver followed{motion, kRate_Hz, 1e-6};
  sim::NumericSolver asked{motion, kRate_Hz, 1e-6};
  Follower follower;
  for (std::int64_t scan = 1; scan < 350; ++scan) {
    followed.follow_to({scan, 0.5}, follower);
    const double end = follower.end;
    ASSERT_NEAR(end, asked.at({scan, 0.5}), 2e-6) << scan;
  }
  EXPECT_NEAR(follower.duration_s, 349.5 / kRate_Hz, 1e-12);
  EXPECT_LE(follower.largest_jump, 2e-6);
}

// The cubics are as short as the accuracy asked for wants them, also where nobody knows that of the whole.
TEST(NumericSolver, ShowsTheForceOfABeltThatNeverEndsAsCloselyAsAsked) {
  class Follower final : public sim::ForceFollower {
   public:
    explicit Follower(const sim::Motion& motion) : exact_{motion, kRate_Hz} {}
    void follow(const sim::ForceStretch& s) override {
      const double middle_s = start_s_ + s.duration_s / 2.0;
      const double scan = std::floor(middle_s * kRate_Hz);
      const double c = exact_.at({static_cast<std::int64_t>(scan), middle_s * kRate_Hz - scan});
      largest_error = std::max(largest_error, std::abs(s.course.value(s.duration_s / 2.0) - c));
      start_s_ += s.duration_s;
    }
    double largest_error = 0.0;

   private:
    sim::Propagator exact_;
    double start_s_ = 0.0;
  };
  sim::Motion motion = motion_at(2.5, kDamping);
  motion.belt[0].duration_s = std::numeric_limits<double>::infinity();
  Follower follower{motion};
  sim::NumericSolver sled{motion, kRate_Hz, 1e-11};
  sled.follow_to({350, 0.0}, follower);
  EXPECT_LE(follower.largest_error, 2e-11);  // The cubic's and the solver's.
}

TEST(Cvode, SaysTheTolerancesThatItHasTriedWhereItGivesUp) {
  class Hopeless final : public sim::OdeSystem {
   public:
    [[nodiscard]] sim::OdeState rate(double /*t_s*/, const sim::OdeState& /*y*/) const override {
      return {std::numeric_limits<double>::quiet_NaN()};
    }
    [[nodiscard]] Jacobian jacobian(double /*t_s*/, const sim::OdeState& /*y*/) const override { return {}; }
    [[nodiscard]] Events events(double /*t_s*/, const sim::OdeState& /*y*/) const override { return {}; }
  };
  const Hopeless system;
  sim::Cvode cvode{sim::Cvode::Method::kAdams, system, 1, 1.0};
  cvode.set_tolerance({1e-9});
  for (int i = 0; i < 2; ++i) {
    cvode.restart({});
    EXPECT_THROW(static_cast<void>(cvode.step()), std::runtime_error);
    EXPECT_EQ(cvode.widened(), 1e6);
  }
}

}  // namespace
}  // namespace stickslip::numeric
