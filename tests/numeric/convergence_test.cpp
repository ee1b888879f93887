// The peers are what they are said to be: each has the order of its method.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include <boost/numeric/odeint.hpp>

#include "core/accuracy/comparison.hpp"
#include "core/accuracy/reference.hpp"
#include "tests/numeric/constants.hpp"
#include "tests/numeric/motion_recorder.hpp"

namespace stickslip::numeric {
namespace {

double error_of(const accuracy::Method& method, const sim::Motion& motion, std::size_t scans) {
  std::vector<double> truth(scans);
  std::vector<double> coefficient(scans);
  accuracy::Reference{motion, kRate_Hz}.next(truth);
  (void)method.run(motion, kRate_Hz, 1, coefficient);
  return accuracy::largest_difference(truth, coefficient);
}

// Dormand and Prince's 5(4) leaves O(h⁵) at a fixed time: halving the step divides the error by 32.
TEST(Convergence, DormandPrinceHasOrderFiveOnASlip) {
  using State = std::array<double, 2>;
  const sim::Motion motion = motion_at(1.3, 0.022);
  const double r = motion.oscillator.stick_rate_per_s(motion.belt[0].speed_m_per_s, kGravity);
  const accuracy::Oscillation50 slip{accuracy::Real(motion.mu_k),
                                     accuracy::Real(motion.mu_s) - accuracy::Real(motion.mu_k),
                                     accuracy::Real(r), accuracy::Real(motion.oscillator.gamma_per_s),
                                     accuracy::Real(motion.oscillator.omega_squared)};
  const auto equation = [&motion](const State& x, State& dx, double /*t*/) {
    dx = {x[1],
          -motion.oscillator.gamma_per_s * x[1] - motion.oscillator.omega0_squared() * (x[0] - motion.mu_k)};
  };
  constexpr double kDuration_s = 0.03;
  const auto error = [&](int steps) {
    State x{motion.mu_s, r};
    boost::numeric::odeint::runge_kutta_dopri5<State> stepper;
    const double step_s = kDuration_s / steps;
    for (int i = 0; i < steps; ++i) stepper.do_step(equation, x, i * step_s, step_s);
    return std::abs(x[0] - static_cast<double>(slip.value(accuracy::Real(kDuration_s))));
  };
  // 16 to 64 steps a period: errors of 1e-5 to 1e-9, far above rounding; the next power of h is 6.
  for (const int steps : {16, 32}) EXPECT_NEAR(std::log2(error(steps) / error(2 * steps)), 5.0, 0.3) << steps;
}

// A step's error is the tolerance, and a cycle starts afresh, so what is added up are times: a thousandth of
// the tolerance leaves a hundredth of the error at the most, with either stepper.
TEST(Convergence, OdeintFollowsItsTolerance) {
  const sim::Motion motion = motion_at(1.3, 0.022);
  for (const auto make : {accuracy::make_dormand_prince, accuracy::make_bulirsch_stoer}) {
    const double coarse = error_of(*make(1e-6), motion, 1000);
    const double fine = error_of(*make(1e-9), motion, 1000);
    const double finest = error_of(*make(1e-12), motion, 1000);
    EXPECT_LT(fine, coarse / 100.0) << make(1e-9)->name();
    EXPECT_LT(finest, fine / 100.0) << make(1e-9)->name();
    EXPECT_LT(fine, 1e-7) << make(1e-9)->name();
  }
}

// The peer goes on in its own steps: scans that lie a hundred times as close are read from the same ones.
TEST(Convergence, OdeintDoesNotStopAtScans) {
  const sim::Motion motion = motion_at(1.3, 0.022);
  constexpr std::size_t kFiner = 100;
  std::vector<double> coarse(100);
  std::vector<double> fine(kFiner * coarse.size());
  for (const auto make : {accuracy::make_dormand_prince, accuracy::make_bulirsch_stoer}) {
    (void)make(1e-6)->run(motion, kRate_Hz, 1, coarse);
    (void)make(1e-6)->run(motion, kFiner * kRate_Hz, 1, fine);
    // Not to the last bit: the times of scans are rounded. A step more or less would show at 1e-7.
    for (std::size_t scan = 0; scan < coarse.size(); ++scan)
      EXPECT_NEAR(coarse[scan], fine[kFiner * scan], 1e-13);
  }
}

// Order 1, seen where no capture is decided anew: a ring-down. Halving the step halves the error.
TEST(Convergence, EulerHasOrderOne) {
  const sim::Motion motion = motion_at(2.6, 0.022, 0.325, 0.30);
  for (const int steps : {64, 128, 256}) {
    const double ratio = error_of(*accuracy::make_euler(steps), motion, 1000) /
                         error_of(*accuracy::make_euler(2 * steps), motion, 1000);
    // The times of the two events before it are found within a step only, half of the error in one or the
    // other.
    EXPECT_GT(ratio, 1.3) << steps;
    EXPECT_LT(ratio, 3.1) << steps;
  }
  // Over a factor of 16 that chance counts for less: order 1 ± 0.2.
  const double order = std::log2(error_of(*accuracy::make_euler(32), motion, 1000) /
                                 error_of(*accuracy::make_euler(512), motion, 1000)) /
                       4.0;
  EXPECT_NEAR(order, 1.0, 0.2);
}

// Smooth friction never converges to this scene: its limit starts slips at a lower force.
TEST(Convergence, SmoothFrictionDoesNotConverge) {
  const sim::Motion motion = motion_at(1.3, 0.022);
  for (const double width : {0.01, 0.003, 0.001}) {
    // It lacks S − S′ = 0.029 at every peak.
    EXPECT_GT(error_of(*accuracy::make_tanh(width), motion, 700), 0.01) << width;
  }
}

TEST(Convergence, PeersTakePartInWholeTests) {
  sim::Motion motion = motion_at(1.3, 0.022);
  motion.one_way_coupling = true;
  motion.belt = {{0.1, 0.0, false}, {1.0, 0.00508, false}, {0.5, 0.0, false}, {0.5, -0.00508, true}};
  sim::Motion slack = motion;  // In each cycle.
  slack.mu_s = 0.75;
  EXPECT_LT(error_of(*accuracy::make_euler(1024), motion, 1000), 1e-2);
  for (const auto make : {accuracy::make_dormand_prince, accuracy::make_bulirsch_stoer}) {
    EXPECT_LT(error_of(*make(1e-9), motion, 1000), 1e-7) << make(1e-9)->name();
    EXPECT_LT(error_of(*make(1e-9), slack, 500), 1e-6) << make(1e-9)->name();
  }
}

// All of them let a sled with slack begin at the speed of a belt that moves at scan 0, also where the segment
// that says so has no length. At rest it would lose r²/(2 ω₀² K) = 0.007 of the force.
TEST(Convergence, SledWithSlackBeginsAtTheSpeedOfTheBelt) {
  sim::Motion motion = motion_at(1.3, 0.022);
  motion.one_way_coupling = true;
  motion.startup_slack_m = 0.1 * motion.belt[0].speed_m_per_s;  // Taut after 35 scans, sticks for 15 more.
  std::vector<double> truth(350);
  accuracy::Reference{motion, kRate_Hz}.next(truth);
  EXPECT_LT(accuracy::largest_difference(trace(motion, kRate_Hz, truth.size()), truth), 1e-10);
  EXPECT_LT(error_of(*accuracy::make_dormand_prince(1e-9), motion, truth.size()), 1e-6);
  // A step of the belt; a width of its speed for 15 scans.
  EXPECT_LT(error_of(*accuracy::make_euler(1024), motion, 45), 1e-4);
  EXPECT_LT(error_of(*accuracy::make_tanh(0.001), motion, 45), 1e-3);
  motion.belt = {{0.0, motion.belt[0].speed_m_per_s}, {1.0, 0.0}, {1.0, motion.belt[0].speed_m_per_s}};
  accuracy::Reference{motion, kRate_Hz}.next(truth);
  EXPECT_LT(accuracy::largest_difference(trace(motion, kRate_Hz, truth.size()), truth), 1e-10);
}

// A belt that comes back without halting, and a sled that it carries away; a tight coupling that is pushed.
TEST(Convergence, OdeintSlidesEitherWay) {
  for (const bool one_way : {true, false}) {
    sim::Motion motion = motion_at(1.3, 0.022);
    motion.one_way_coupling = one_way;
    motion.belt = {{1.0, 0.00508, false}, {1.0, -0.00508, false}, {1.0, 0.01, false}};
    for (const auto make : {accuracy::make_dormand_prince, accuracy::make_bulirsch_stoer})
      EXPECT_LT(error_of(*make(1e-9), motion, 1050), 1e-6) << make(1e-9)->name() << one_way;
  }
}

}  // namespace
}  // namespace stickslip::numeric
