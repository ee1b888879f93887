#include "core/estimate/shared_posterior.hpp"

#include <gtest/gtest.h>

namespace stickslip::estimate {
namespace {

constexpr double kOmega = 125.0;
constexpr double kStickRate = 8.0;

/// Cycles after which what has only faded is far below the smallest number: (31/32)ⁿ < 10⁻³²⁴ from n = 23 500
/// on.
constexpr int kADay = 50'000;

/// What each cycle tells of one of (ω, γ, r) alone.
SharedEvidence evidence_of(Eigen::Index which, double value, double standard_error) {
  SharedEvidence evidence;
  evidence.information(which, which) = 1.0 / (standard_error * standard_error);
  evidence.weighted[which] = evidence.information(which, which) * value;
  return evidence;
}

// Turning points tell nothing of γ: after any number of them it is what it was.
TEST(SharedPosterior, WhatNoCycleTellsStaysAsItWas) {
  SharedPosterior knowledge{SharedPrior{}};
  knowledge.start(kOmega, kStickRate);
  const double gamma_at_first = knowledge.best().gamma;
  const double omega = 1.02 * kOmega;
  for (int cycle = 0; cycle < kADay; ++cycle) knowledge.learn(evidence_of(0, omega, 0.02 * omega));
  // Sums of 30 terms that round, over each other.
  constexpr double kRounding = 1e-12;
  EXPECT_NEAR(knowledge.best().gamma, gamma_at_first, kRounding * gamma_at_first);
  EXPECT_NEAR(knowledge.best().r, kStickRate, kRounding * kStickRate);
  // The first ω was known to 15 %; a millionth of that weight is left beside 32 cycles of 2 %.
  const double first = 1e-6 / (0.15 * 0.15);
  const double cycles = 32.0 / (0.02 * 0.02);
  EXPECT_NEAR(knowledge.best().omega, omega, 1.1 * first / cycles * (omega - kOmega));
}

// A new belt speed is a new first knowledge.
TEST(SharedPosterior, AForgottenStickRateStaysAsItWasThen) {
  SharedPosterior knowledge{SharedPrior{}};
  knowledge.start(kOmega, kStickRate);
  for (int cycle = 0; cycle < 10; ++cycle) knowledge.learn(evidence_of(2, kStickRate, 0.05 * kStickRate));
  knowledge.forget_stick_rate(2.0 * kStickRate);
  for (int cycle = 0; cycle < kADay; ++cycle) knowledge.learn(evidence_of(0, kOmega, 0.02 * kOmega));
  constexpr double kRounding = 1e-12;
  EXPECT_NEAR(knowledge.best().r, 2.0 * kStickRate, kRounding * kStickRate);
}

}  // namespace
}  // namespace stickslip::estimate
