// Rate-and-state friction against what is published about it, and where its numbers get out of hand.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/sim/cvode.hpp"
#include "core/sim/numeric_solver.hpp"
#include "core/sim/rate_and_state_system.hpp"
#include "core/sim/scene.hpp"
#include "core/sim/scene_run.hpp"
#include "tests/numeric/constants.hpp"
#include "tests/numeric/motion_recorder.hpp"

namespace stickslip::numeric {
namespace {

using sim::RateAndState;
using Law = RateAndState::Law;

sim::Motion rate_and_state_motion(const RateAndState& law, std::vector<sim::BeltSegment> belt) {
  sim::Motion motion = motion_at(1.0, 0.022);
  motion.belt = std::move(belt);
  motion.rate_and_state = law;
  return motion;
}

std::vector<double> scans_of(const sim::Motion& motion, double accuracy, double duration_s) {
  sim::NumericSolver sled{motion, kRate_Hz, accuracy};
  std::vector<double> coefficient(static_cast<std::size_t>(duration_s * kRate_Hz));
  sled.next(coefficient);
  return coefficient;
}

// a > b slides steadily: μ = μ₀ + (a − b) ln(V/V₀).
TEST(RateAndStateFriction, SteadySlidingHasThePublishedFriction) {
  for (const Law law : {Law::kAgeing, Law::kSlip}) {
    for (const double speed : {1e-3, 1e-2}) {
      const RateAndState settings{law, 0.02, 0.01, 1e-5, 1e-6, 0.3};
      const double accuracy = 1e-7;
      const double end = scans_of(rate_and_state_motion(settings, {{3.0, speed}}), accuracy, 3.0).back();
      EXPECT_NEAR(end, 0.3 + 0.01 * std::log(speed / 1e-6), accuracy);
    }
  }
}

// At once, before θ can change: a ln(V₂/V₁). The asinh differs from it by a e^(−2μ/a) < 1e-26.
TEST(RateAndStateFriction, AStepOfVelocityIsAnsweredByTheDirectEffect) {
  const RateAndState settings{Law::kAgeing, 0.01, 0.02, 1e-5, 1e-6, 0.3};
  const sim::RateAndStateSystem system{settings, motion_at(1.0, 0.0).oscillator, kGravity};
  const double psi = -3.0;
  EXPECT_NEAR(system.friction(1e-2, psi) - system.friction(1e-3, psi), 0.01 * std::numbers::ln10, 1e-15);
}

/// Does a small disturbance of steady sliding grow? Largest |c − μ| late over early.
bool grows(const RateAndState& settings, double speed, double omega0_squared) {
  const auto oscillator = model::Oscillator::from_omega0(omega0_squared, 0.0);
  sim::RateAndStateSystem system{settings, oscillator, kGravity};
  sim::RateAndStateSystem::Piece piece;
  piece.belt.rate = oscillator.stick_rate_per_s(speed, kGravity);
  system.begin(piece);
  // Steady: θ = D_c/V.
  const double psi = -std::log(speed / settings.reference_speed_m_per_s);
  const double mu = system.friction(speed, psi);
  // Of the oscillation at the critical stiffness. [Ruina 1983; Rice and Ruina 1983]
  const double period_s = 2.0 * std::numbers::pi * settings.critical_slip_m / speed *
                          std::sqrt(settings.a / (settings.b - settings.a));
  sim::Cvode cvode{sim::Cvode::Method::kBdf, system, 3, 1e-3 * period_s};
  cvode.set_tolerance({1e-13, 1e-13, 1e-11});
  cvode.restart({mu + 1e-3 * settings.a, mu, psi});
  double early = 0.0;
  double late = 0.0;
  for (double t_s = 0.0; t_s < 6.0 * period_s;) {
    t_s = cvode.step().t_s;
    const double away = std::abs(cvode.state_at(t_s)[0] - mu);
    if (t_s > 1.0 * period_s && t_s < 2.0 * period_s) early = std::max(early, away);
    if (t_s > 5.0 * period_s) late = std::max(late, away);
  }
  return late > early;
}

// k_c = (b − a) σ/D_c · (1 + m V²/(σ a D_c)), σ = m g. [Rice and Ruina, J. Appl. Mech. 50:343–349, 1983]
// At the higher speed inertia makes 10 % of it.
TEST(RateAndStateFriction, SteadySlidingIsStableAboveThePublishedStiffness) {
  for (const Law law : {Law::kAgeing, Law::kSlip}) {
    for (const double speed : {1e-5, 1e-3}) {
      const RateAndState settings{law, 0.01, 0.02, 1e-4, 1e-6, 0.3};
      const double published = (settings.b - settings.a) * kGravity / settings.critical_slip_m *
                               (1.0 + speed * speed / (kGravity * settings.a * settings.critical_slip_m));
      double soft = 0.9 * published;
      double stiff = 1.1 * published;
      ASSERT_TRUE(grows(settings, speed, soft));
      ASSERT_FALSE(grows(settings, speed, stiff));
      while (stiff - soft > 0.002 * published) {
        const double middle = (soft + stiff) / 2.0;
        (grows(settings, speed, middle) ? soft : stiff) = middle;
      }
      EXPECT_NEAR(soft / published, 1.0, 0.01) << speed;
    }
  }
}

// The whole of a test, with a contact that sticks and slips: stretched, stopped, unloaded, at rest.
std::vector<sim::BeltSegment> whole_test() {
  return {{0.2, 0.0}, {1.0, 0.002}, {0.2, 0.0}, {0.5, -0.01, true}};
}

TEST(RateAndStateFriction, AccuracyIsWhatWasAskedFor) {
  for (const Law law : {Law::kAgeing, Law::kSlip}) {
    const sim::Motion motion = rate_and_state_motion({law, 0.01, 0.02, 1e-6, 1e-6, 0.35}, whole_test());
    const std::vector<double> reference = scans_of(motion, 1e-8, 2.0);
    for (const double accuracy : {1e-3, 1e-5, 1e-6}) {
      const std::vector<double> scans = scans_of(motion, accuracy, 2.0);
      for (std::size_t i = 0; i < scans.size(); ++i) ASSERT_NEAR(scans[i], reference[i], accuracy) << i;
    }
  }
}

TEST(RateAndStateFriction, TinyCriticalSlipAndSpeedsDownToZeroStayFinite) {
  for (const Law law : {Law::kAgeing, Law::kSlip}) {
    for (const double critical_slip_m : {1e-8, 1e-7}) {
      sim::Motion motion =
          rate_and_state_motion({law, 0.005, 0.01, critical_slip_m, 1e-9, 0.35}, whole_test());
      motion.one_way_coupling = true;
      MotionRecorder recorder{kRate_Hz};
      sim::NumericSolver sled{motion, kRate_Hz, 1e-4, &recorder};
      std::vector<double> scans(700);
      sled.next(scans);
      for (const double c : scans) ASSERT_TRUE(c >= 0.0 && c < 0.7) << c;
      EXPECT_GE(recorder.onsets_s.size(), 3U);
      EXPECT_EQ(scans.back(), 0.0);  // Unloaded.
      EXPECT_EQ(sled.method().accuracy, 1e-4);
    }
  }
}

// Ageing from no rest at all: the longer the contact has rested, the higher the first peak, by b for each
// e-fold of a long rest.
TEST(RateAndStateFriction, AContactThatHasNotRestedIsWeak) {
  const RateAndState settings{Law::kAgeing, 0.01, 0.02, 1e-6, 1e-6, 0.35};
  const auto first_peak = [&](double idle_s) {
    const std::vector<double> scans =
        scans_of(rate_and_state_motion(settings, {{idle_s, 0.0}, {0.5, 0.002}}), 1e-5, idle_s + 0.4);
    return *std::max_element(scans.begin(), scans.end());
  };
  const double fresh = first_peak(0.0);
  const double hundred_s = first_peak(100.0);
  const double thousand_s = first_peak(1000.0);
  EXPECT_GT(fresh, 0.2);
  EXPECT_LT(fresh, hundred_s);
  // Scans see the peak to 10 % of what the force rises in a scan, and the rise adds its own age.
  EXPECT_NEAR(thousand_s - hundred_s, 0.02 * std::numbers::ln10, 0.003);
}

// An unloaded sled on a belt at rest creeps by roundings: the coupling that is neither taut nor slack is no
// event without end.
TEST(RateAndStateFriction, AnUnloadedSledOnABeltAtRestGetsToItsPull) {
  auto scene = sim::load_scene(std::filesystem::path{STICKSLIP_SOURCE_DIR} /
                               "config/scenes/rate-and-state-ageing.toml");
  ASSERT_TRUE(scene) << scene.error().message;
  scene->constant_speed.reset();
  scene->accuracy = 1e-5;
  scene->duration_s = 1.0;
  scene->piecewise_speed = sim::PiecewiseSpeed{{{0.5, 0.0}, {0.5, 0.00508}}};
  std::vector<RateAndState> laws{
      {Law::kAgeing, 0.0126409185, 0.0252933892, 1.12947928e-5, 1e-3, 0.299520942}};
  std::mt19937_64 random{20261128};
  std::uniform_real_distribution<double> fraction{0.0, 1.0};
  for (int i = 0; i < 30; ++i) {
    const double a = 0.004 + 0.016 * fraction(random);
    laws.push_back({i % 2 == 0 ? Law::kAgeing : Law::kSlip, a, a * (1.6 + 2.0 * fraction(random)),
                    1e-6 + 1e-5 * fraction(random), 1e-3, 0.3});
  }
  for (const RateAndState& law : laws) {
    scene->rate_and_state = law;
    for (const double rate_Hz : {350.0, 5600.0}) {
      sim::SceneRun run{*scene, rate_Hz};
      std::vector<double> raw(static_cast<std::size_t>(rate_Hz));
      EXPECT_EQ(run.next(raw), raw.size());
    }
  }
}

// The accuracy that is asked for bounds the first rest, also where nobody knows that of the whole.
TEST(RateAndStateFriction, ABeltThatNeverEndsMovesTheSledAsOneThatEndsLater) {
  for (const Law law : {Law::kAgeing, Law::kSlip}) {
    const RateAndState settings{law, 0.01, 0.02, 1e-6, 1e-6, 0.35};
    const auto scans = [&settings](double duration_s) {
      return scans_of(rate_and_state_motion(settings, {{duration_s, 0.002}}), 1e-6, 0.5);
    };
    const std::vector<double> endless = scans(std::numeric_limits<double>::infinity());
    const std::vector<double> ends = scans(0.5);
    // Each has its error.
    for (std::size_t i = 0; i < ends.size(); ++i) ASSERT_NEAR(endless[i], ends[i], 2e-6) << i;
  }
}

RC_GTEST_PROP(RateAndStateProperty, TheJacobianIsThatOfTheRates, ()) {
  const auto fraction = [] { return *rc::gen::inRange(1, 1000) / 1000.0; };
  const RateAndState settings{*rc::gen::element(Law::kAgeing, Law::kSlip),
                              0.02 + 0.05 * fraction(),
                              0.1 * fraction(),
                              1e-4,
                              1e-5,
                              0.1 * fraction()};
  sim::RateAndStateSystem system{settings, motion_at(1.0, 0.022).oscillator, kGravity};
  sim::RateAndStateSystem::Piece piece;
  piece.taut = *rc::gen::arbitrary<bool>();
  piece.belt.rate = 5.0 * fraction();
  system.begin(piece);
  const double sign = *rc::gen::element(1.0, -1.0);
  const sim::OdeState y{fraction(), sign * (0.01 + 0.2 * fraction()), 2.0 * fraction() - 1.0};
  const auto jacobian = system.jacobian(0.0, y);
  for (std::size_t column = 0; column < 3; ++column) {
    const double step = 1e-6;
    sim::OdeState above = y;
    sim::OdeState below = y;
    above[column] += step;
    below[column] -= step;
    const sim::OdeState high = system.rate(0.0, above);
    const sim::OdeState low = system.rate(0.0, below);
    for (std::size_t row = 0; row < 3; ++row) {
      const double slope = (high[row] - low[row]) / (2.0 * step);
      // Differences: step²/a² relative, and roundings of the rate over the step.
      const double scale = std::abs(high[row]) + std::abs(low[row]) + std::abs(jacobian[row][column]);
      RC_ASSERT(std::abs(slope - jacobian[row][column]) <= 1e-5 * std::abs(slope) + 1e-8 * scale + 1e-9);
    }
  }
}

RC_GTEST_PROP(RateAndStateProperty, SpeedAndFrictionAreEachOthersInverse, ()) {
  const RateAndState settings{Law::kAgeing, 0.01, 0.02, 1e-6, 1e-6, 0.3};
  const sim::RateAndStateSystem system{settings, motion_at(1.0, 0.0).oscillator, kGravity};
  const double exponent = *rc::gen::inRange(-300, 10);
  const double psi = *rc::gen::inRange(-20, 20);
  const double speed = *rc::gen::element(1.0, -1.0) * std::pow(10.0, exponent / 10.0);
  const double friction = system.friction(speed, psi);
  // V is exponential in μ/a: a rounding of μ ≤ 1 is 1e-16/a of V, and so is one of the exponent.
  RC_ASSERT(std::abs(system.speed_m_per_s(friction, psi) / speed - 1.0) <= 1e-12);
}

}  // namespace
}  // namespace stickslip::numeric
