// The same physics by the most pedestrian means: tiny steps and Coulomb's two sentences. It knows
// nothing of phases, events or closed forms, so it can disagree.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "tests/numeric/motion_recorder.hpp"

namespace stickslip::numeric {
namespace {

constexpr double kStep_s = 1e-6;
constexpr double kScanRate_Hz = 500.0;  // 2000 steps a scan.

/// Extension x and its speed in units of the coefficient; explicit midpoint steps.
std::vector<double> stepped(const sim::Motion& motion, std::size_t count) {
  const double omega0_squared = motion.oscillator.omega0_squared();
  const double gamma = motion.oscillator.gamma_per_s;
  const auto pull = [&](double x, double v) {
    return motion.one_way_coupling && x < 0.0 ? 0.0 : -omega0_squared * x - gamma * v;
  };
  std::vector<double> coefficient;
  double x = 0.0;
  double v = 0.0;
  std::size_t segment = 0;
  double segment_end_s = motion.belt[0].duration_s;
  bool halted = false;
  constexpr std::size_t kStepsPerScan = 2000;
  for (std::size_t step = 0; coefficient.size() < count; ++step) {
    const double now_s = static_cast<double>(step) * kStep_s;
    if (step % kStepsPerScan == 0) coefficient.push_back(motion.one_way_coupling ? std::fmax(x, 0.0) : x);
    while (segment < motion.belt.size() && now_s > segment_end_s - kStep_s / 2.0) {
      halted = false;
      if (++segment < motion.belt.size()) segment_end_s += motion.belt[segment].duration_s;
    }
    double belt = 0.0;
    if (segment < motion.belt.size()) {
      if (motion.belt[segment].halt_when_unloaded && x <= 0.0) halted = true;
      if (!halted) belt = omega0_squared * motion.belt[segment].speed_m_per_s / motion.gravity_m_per_s2;
    }
    const double spring = motion.one_way_coupling && x < 0.0 ? 0.0 : x;
    if (v == belt && std::abs(spring) <= motion.mu_s) {
      x += belt * kStep_s;
      continue;
    }
    const bool slower = v != belt ? v < belt : spring > 0.0;
    const double friction = (slower ? 1.0 : -1.0) * omega0_squared * motion.mu_k;
    const double middle_x = x + v * kStep_s / 2.0;
    const double middle_v = v + (pull(x, v) + friction) * kStep_s / 2.0;
    const double next_v = v + (pull(middle_x, middle_v) + friction) * kStep_s;
    x += middle_v * kStep_s;
    const bool met = v != belt && (next_v - belt) * (v - belt) <= 0.0;
    v = met ? belt : next_v;
  }
  return coefficient;
}

/// Each event is found up to a step late, which shifts what follows by up to c′ · step ≈ 6e-5 (the
/// fastest scene here reaches c′ = 60/s); sticking forgets most of it before it can add up.
constexpr double kTolerance = 5e-4;

void expect_the_same(const sim::Motion& motion) {
  constexpr std::size_t kScans = 600;
  const std::vector<double> reference = stepped(motion, kScans);
  const std::vector<double> exact = trace(motion, kScanRate_Hz, kScans);
  for (std::size_t i = 0; i < kScans; ++i) ASSERT_NEAR(exact[i], reference[i], kTolerance) << "scan " << i;
}

sim::Motion whole_test(double mu_s, double damping, bool one_way) {
  sim::Motion motion = motion_at(1.0, damping, mu_s, 0.30);
  motion.one_way_coupling = one_way;
  motion.belt = {{0.05, 0.0, false},
                 {0.50, 0.00508, false},
                 {0.10, 0.0, false},
                 {0.20, -0.00508, one_way},
                 {0.10, 0.002, false}};
  return motion;
}

TEST(PropagatorStepping, StickSlip) { expect_the_same(whole_test(0.35, 0.022, true)); }
TEST(PropagatorStepping, RingDown) { expect_the_same(whole_test(0.325, 0.022, true)); }
TEST(PropagatorStepping, SlackInEachCycle) { expect_the_same(whole_test(0.70, 0.01, true)); }
TEST(PropagatorStepping, TwoWayCouplingPulledBackwards) { expect_the_same(whole_test(0.35, 0.022, false)); }
TEST(PropagatorStepping, StrongDamping) { expect_the_same(whole_test(0.35, 0.7, true)); }

TEST(PropagatorStepping, BeltThatChangesItsSpeedInFlight) {
  sim::Motion motion = motion_at(1.0, 0.022, 0.35, 0.10);
  for (int i = 0; i < 40; ++i) motion.belt.push_back({0.023, i % 2 == 0 ? 0.02 : -0.013, false});
  motion.belt.erase(motion.belt.begin());
  expect_the_same(motion);
}

}  // namespace
}  // namespace stickslip::numeric
