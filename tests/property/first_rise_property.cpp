// The chain of derivatives beside brute force: thousands of points.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "core/sim/first_rise.hpp"

namespace stickslip::sim {
namespace {

double some(double low, double high) { return low + (high - low) * *rc::gen::inRange(0, 1001) / 1000.0; }

Curve some_curve() {
  Curve y;
  y.wave.oscillator =
      model::Oscillator::from_omega0(some(10.0, 400.0), *rc::gen::element(0.0, 0.02, 0.5, 3.0, 15.0, 60.0));
  if (*rc::gen::inRange(0, 4) != 0) {
    y.wave.D = some(-2.0, 2.0);
    y.wave.r = some(-20.0, 20.0);
  }
  for (int k = 0; k < *rc::gen::inRange(0, 5); ++k) y.course.add_power(k, some(-2.0, 2.0));
  for (int j = 0; j < *rc::gen::inRange(0, 3); ++j) {
    y.course.add_decay(*rc::gen::element(0.01, 0.5, 3.0, 30.0), *rc::gen::inRange(0, 3), some(-2.0, 2.0));
  }
  return y;
}

constexpr double kEnd_s = 4.0;

RC_GTEST_PROP(FirstRise, IsTheFirstOfAllSignChangesUpwards, ()) {
  const Curve y = some_curve();
  const auto found = first_rise_s(y, 0.0, kEnd_s, Touch::kDoesNot);
  // Dense enough for 20 rad/s and decays of 30/s; what rises and falls between two points is no mistake of
  // the sampling's that could be held against the chain, so only the other way round is asked.
  constexpr int kPoints = 20'000;
  std::optional<double> sampled;
  double before = y.value(0.0);
  for (int i = 1; i <= kPoints && !sampled; ++i) {
    const double now = y.value(kEnd_s * i / kPoints);
    if (before < -1e-12 && now > 1e-12) sampled = kEnd_s * i / kPoints;
    if (std::abs(now) > 1e-12) before = now;
  }
  if (sampled) {
    RC_ASSERT(found.has_value());
    RC_ASSERT(*found <= *sampled + 1e-12);
  }
  if (found && *found > 0.0) {
    // It is a zero, negative shortly before and positive shortly after, as far as roundings let it show.
    const double size = 1.0 + y.course.magnitude(*found) + std::abs(y.wave.D) + std::abs(y.wave.r);
    RC_ASSERT(std::abs(y.value(*found)) < 1e-13 * size);
    RC_ASSERT(y.value(std::fmax(0.0, *found - 1e-5)) < 1e-13 * size);
    if (*found < kEnd_s - 1e-5) RC_ASSERT(y.value(*found + 1e-5) > -1e-9 * size);
  }
}

// A wave alone has two ways to its answer.
RC_GTEST_PROP(FirstRise, AgreesWithTheClosedFormOfAWaveAndALevel, ()) {
  Curve y = some_curve();
  const double level = y.wave.D + some(0.001, 3.0);
  y.course = ExponentialPolynomial{-level};
  const auto closed = first_rise_s(y.wave, level, Touch::kCounts);
  const auto chain = first_rise_s(y, 0.0, 1e6, Touch::kCounts);
  RC_ASSERT(closed.has_value() == chain.has_value());
  // At a slope s the time is good to the roundings of y over s.
  if (closed) RC_ASSERT(std::abs(y.value(*chain) - y.value(*closed)) < 1e-13);
  if (closed && y.wave.rate(*closed) > 1e-3) RC_ASSERT(std::abs(*closed - *chain) < 1e-10);
}

// The oscillation dies out in a second; the line crosses zero after a day, or after ten years.
TEST(FirstRise, DoesNotStepThroughWhatHasDiedOut) {
  for (const double wait_s : {86'400.0, 3e8}) {
    Curve y{{0.0, 0.3, 0.0, model::Oscillator::from_omega(125.0, 0.05)}, ExponentialPolynomial{-1.0}};
    y.course.add_power(1, 1.0 / wait_s);
    const auto found = first_rise_s(y, 0.0, 1e12, Touch::kDoesNot);
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found / wait_s, 1.0, 1e-14);
  }
}

// sin − 1 touches zero from below; ten years of it are not searched period by period.
TEST(FirstRise, TouchingCountsWhereItIsAskedTo) {
  const double omega = 125.0;
  Curve y{{0.0, -0.5, 0.0, model::Oscillator::from_omega(omega, 0.0)}, ExponentialPolynomial{-0.5}};
  const auto touch = first_rise_s(y, 0.0, 3e8, Touch::kCounts);
  ASSERT_TRUE(touch);
  // The square root of the rounding.
  EXPECT_NEAR(*touch, std::numbers::pi / omega, 2e-8 / omega);
  EXPECT_FALSE(first_rise_s({y.wave, ExponentialPolynomial{-0.5 - 1e-12}}, 0.0, 3e8, Touch::kCounts));
  EXPECT_TRUE(first_rise_s({y.wave, ExponentialPolynomial{-0.5 + 1e-12}}, 0.0, 3e8, Touch::kDoesNot));
}

// From zero upwards at once is now; from zero downwards it comes back.
TEST(FirstRise, StartsAtZeroOnEitherSide) {
  ExponentialPolynomial up{0.0};
  up.add_power(1, 1.0);
  EXPECT_EQ(first_rise_s({{}, up}, 0.0, 10.0, Touch::kDoesNot), 0.0);
  ExponentialPolynomial down{0.0};
  down.add_power(1, -1.0);
  down.add_power(2, 0.5);
  const auto back = first_rise_s({{}, down}, 0.0, 10.0, Touch::kDoesNot);
  ASSERT_TRUE(back);
  EXPECT_NEAR(*back, 2.0, 1e-15);
  EXPECT_FALSE(first_rise_s({{}, down}, 0.0, 1.9, Touch::kDoesNot));
}

}  // namespace
}  // namespace stickslip::sim
