#include "core/model/slip_model.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/model_course.hpp"

namespace stickslip::model {
namespace {

using test::ModelCourse;

constexpr SlipParameters kSlip{0.05, ModelCourse::kS, ModelCourse::kK};

/// All six in the order onset, S, K, ω, γ, r.
using Six = std::array<double, 6>;

double value_at(const Six& p, bool captured, double time_s) {
  return SlipModel{{p[3], p[4], p[5]}, {p[0], p[1], p[2]}, captured}.at(time_s).value;
}

/// Central difference with one step of Richardson's extrapolation: error O(h⁴).
double difference_quotient(Six p, std::size_t i, double h, bool captured, double time_s) {
  const auto central = [&](double step) {
    Six up = p;
    Six down = p;
    up[i] += step;
    down[i] -= step;
    return (value_at(up, captured, time_s) - value_at(down, captured, time_s)) / (up[i] - down[i]);
  };
  return (4.0 * central(0.5 * h) - central(h)) / 3.0;
}

void expect_derivatives_agree(const SharedParameters& shared, bool captured,
                              const std::vector<double>& times_s) {
  const Six p{kSlip.onset_s, kSlip.S, kSlip.K, shared.omega, shared.gamma, shared.r};
  // Natural scales: h moves the phase, the decay or the levels by a thousandth or less.
  const double time_scale = 1.0 / shared.omega;
  const double level = kSlip.S - kSlip.K;
  const Six h{1e-3 * time_scale,   1e-3 * level,        1e-3 * level,
              1e-4 * shared.omega, 1e-4 * shared.omega, 1e-3 * shared.r};
  const SlipModel model{shared, kSlip, captured};
  for (const double time_s : times_s) {
    const SlipModelPoint point = model.at(time_s);
    for (std::size_t i = 0; i < 6; ++i) {
      const double analytic = point.by[static_cast<Eigen::Index>(i)];
      // Truncation (h/scale)⁴ = 1e-12 times the phase ωτ ≤ 20 to the fourth at worst: 1e-7 of
      // the swing over the scale; rounding ε·c/h = 1e-12 of it.
      const double scale = (level + shared.r / shared.omega) / (h[i] * 1e3);
      EXPECT_NEAR(difference_quotient(p, i, h[i], captured, time_s), analytic, 1e-7 * scale)
          << "parameter " << i << " at " << time_s;
    }
  }
}

TEST(SlipModel, DerivativesAreThoseOfTheCapturedCourse) {
  for (const double Q : {0.3, 1.3, 1.8}) {
    const SharedParameters shared = ModelCourse::tester_at(Q);
    const double capture_s = SlipModel{shared, kSlip, true}.capture_s();
    ASSERT_LT(capture_s, 2.0 * std::numbers::pi / shared.omega);
    expect_derivatives_agree(shared, true,
                             {kSlip.onset_s - 0.03, kSlip.onset_s - 0.001,                          // stick
                              kSlip.onset_s + 0.001, kSlip.onset_s + 0.4 * capture_s,               // slip
                              kSlip.onset_s + 0.95 * capture_s,                                     // its end
                              kSlip.onset_s + 1.05 * capture_s, kSlip.onset_s + 1.5 * capture_s});  // stick
  }
}

TEST(SlipModel, DerivativesAreThoseOfTheFreeCourse) {
  expect_derivatives_agree(ModelCourse::tester_at(2.6), false,
                           {0.02, kSlip.onset_s + 0.001, kSlip.onset_s + 0.02, kSlip.onset_s + 0.15});
}

TEST(SlipModel, ForceAndItsRateAreContinuousAtOnsetAndCapture) {
  const SharedParameters shared = ModelCourse::tester_at(1.3);
  const SlipModel model{shared, kSlip, true};
  for (const double at_s : {kSlip.onset_s, kSlip.onset_s + model.capture_s()}) {
    // Both sides by ε: c moves by r ε, c′ by ω² D ε at most.
    const double eps_s = 1e-9;
    const SlipModelPoint before = model.at(at_s - eps_s);
    const SlipModelPoint after = model.at(at_s + eps_s);
    EXPECT_NEAR(after.value - before.value, 2.0 * shared.r * eps_s, 1e-3 * shared.r * eps_s);
    // −∂c/∂onset is c′: r at both ends of the slip.
    EXPECT_NEAR(-before.by[0], shared.r, 1e-6 * shared.r);
    EXPECT_NEAR(-after.by[0], shared.r, 1e-6 * shared.r);
    EXPECT_LT((after.by_slip().tail<2>() - before.by_slip().tail<2>()).norm(), 1e-6);
  }
}

TEST(SlipModel, IsTheWaveformDuringTheSlip) {
  const SharedParameters shared = ModelCourse::tester_at(1.3);
  const SlipModel model{shared, kSlip, true};
  for (const double tau_s : {0.0, 0.01, 0.03}) {
    // Two ways to write (11): a few roundings of numbers below 0.5.
    EXPECT_NEAR(model.at(kSlip.onset_s + tau_s).value, model.waveform().value(tau_s), 1e-14);
  }
  EXPECT_EQ(model.at(kSlip.onset_s).value, kSlip.S);
}

TEST(SlipModel, WithoutCaptureTheOscillationGoesOnForEver) {
  const SlipModel model{ModelCourse::tester_at(1.3), kSlip, false};
  EXPECT_EQ(model.capture_s(), std::numeric_limits<double>::infinity());
  // e^(−γt/2) after 10 s is 1e-12 of the swing of 0.05.
  EXPECT_NEAR(model.at(kSlip.onset_s + 10.0).value, kSlip.K, 1e-12);
}

TEST(SlipModel, SaidToBeCapturedAboveTheThresholdItSticksAtTheEndOfTheRise) {
  const SlipModel model{ModelCourse::tester_at(2.6), kSlip, true};
  EXPECT_EQ(model.capture_s(), model.waveform().rise_end_time_s());
}

TEST(SlipModel, CurvatureIsTheSecondDerivativeOfTheForce) {
  const SharedParameters shared = ModelCourse::tester_at(1.3);
  const SlipModel model{shared, kSlip, true};
  for (const double part : {0.1, 0.5, 0.9}) {
    const double tau_s = part * model.capture_s();
    const double expected = model.waveform().acceleration(tau_s);
    // Both are a few roundings of numbers up to ω₀² D.
    EXPECT_NEAR(model.at(kSlip.onset_s + tau_s).curvature, expected,
                1e-13 * shared.oscillator().omega0_squared());
  }
  EXPECT_EQ(model.at(kSlip.onset_s - 0.01).curvature, 0.0);
  EXPECT_EQ(model.at(kSlip.onset_s + model.capture_s() + 0.01).curvature, 0.0);
}

TEST(TurnedBasis, IsTheDampedBasisAtEqualOtherAndFallingSteps) {
  const Oscillator oscillator = Oscillator::from_omega(125.0, 0.022);
  TurnedBasis basis{oscillator};
  double tau_s = 0.001;
  const auto expect_equal = [&] {
    const DampedBasis turned = basis.at(tau_s);
    const DampedBasis computed = damped_basis(oscillator, tau_s);
    // Each of 200 turns adds ε; times are rounded to 1e-16 of ω τ < 100.
    EXPECT_NEAR(turned.cosine, computed.cosine, 1e-12) << tau_s;
    EXPECT_NEAR(125.0 * turned.sine, 125.0 * computed.sine, 1e-12) << tau_s;
  };
  for (int scan = 0; scan < 200; ++scan, tau_s += 1.0 / 350.0) expect_equal();
  tau_s += 3.0 / 350.0;  // Scans that are left out.
  for (int scan = 0; scan < 20; ++scan, tau_s += 1.0 / 350.0) expect_equal();
  tau_s = 0.0003;  // The next slip.
  for (int scan = 0; scan < 20; ++scan, tau_s += 1.0 / 350.0) expect_equal();
}

}  // namespace
}  // namespace stickslip::model
