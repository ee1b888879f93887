// The ends of slips by the heights of falls alone.

#include "core/detect/fall_heights.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stickslip::detect {
namespace {

/// Of the paper's tester [Penner 1995, (19)].
constexpr double kGammaOver2Omega = 0.022;
constexpr double kDrop = 0.16;
constexpr double kSigma = 0.001;
const double kDecisive = std::log(1e4);

TEST(FallHeights, AFreeOscillationShrinksByItsDecrement) {
  EXPECT_NEAR(FallHeights::freely_next(kDrop, kGammaOver2Omega),
              kDrop * std::exp(-2.0 * std::numbers::pi * kGammaOver2Omega), 1e-15);
  EXPECT_EQ(FallHeights::freely_next(kDrop, 0.0), kDrop);
}

// Six standard deviations of both ends, and two hundredths for what is missed between scans.
TEST(FallHeights, WhatIsMoreThanFreelyWasStuckInBetween) {
  const double noise = std::numbers::sqrt2 * 6.0 * kSigma;
  const double limit = (0.14 + noise) / 0.98;
  EXPECT_FALSE(FallHeights::is_more_than(limit - 1e-9, 0.14, kSigma));
  EXPECT_TRUE(FallHeights::is_more_than(limit + 1e-9, 0.14, kSigma));
}

TEST(FallHeights, DecideWhereTheDampingIsKnownAndDoubtWhereItIsNot) {
  const double free = FallHeights::freely_next(kDrop, kGammaOver2Omega);
  FallHeights heights;
  EXPECT_GT(heights.evidence(kDrop, kDrop, free, true, kSigma), kDecisive);
  EXPECT_LT(std::abs(heights.evidence(kDrop, kDrop, free, false, kSigma)), kDecisive);
  EXPECT_LT(heights.evidence(kDrop, free, free, true, kSigma), 0.0);
}

// The usual drop is the geometric mean, of the last sixteen or so.
TEST(FallHeights, LearnWhatIsUsual) {
  FallHeights heights;
  EXPECT_EQ(heights.usual_drop(0.7), 0.7);
  double log_sum = 0.0;
  for (int i = 0; i < 10; ++i) {
    const double next = kDrop * std::exp(0.1 * std::sin(3.0 * i));
    (void)heights.evidence(kDrop, next, 0.9 * kDrop, true, kSigma);
    heights.learn();
    log_sum += std::log(next);
    EXPECT_NEAR(heights.usual_drop(0.0), std::exp(log_sum / (i + 1.0)), 1e-12) << i;
  }
  EXPECT_EQ(heights.count(), 10.0);
  for (int i = 0; i < 200; ++i) {
    (void)heights.evidence(kDrop, 2.0 * kDrop, 0.9 * kDrop, true, kSigma);
    heights.learn();
  }
  EXPECT_EQ(heights.count(), FallHeights::kMemory);
  // (15/16)^190 of the first ten is left.
  EXPECT_NEAR(heights.usual_drop(0.0), 2.0 * kDrop, 1e-5 * kDrop);
}

}  // namespace
}  // namespace stickslip::detect
