#include "core/detect/slip_rule.hpp"

#include <gtest/gtest.h>

namespace stickslip::detect {
namespace {

constexpr double kSigma = 0.5;

/// A fall that begins at scan `peak_at` after a rise of `rise` scans and drops by so many σ.
Fall fall_of(double drop_sigmas, double duration = 3.0, double peak_at = 100.0, double rise = 20.0) {
  Fall fall;
  fall.peak_at = peak_at;
  fall.trough_at = peak_at + duration / 0.8;
  fall.robust_drop = drop_sigmas * kSigma;
  fall.peak = fall.robust_drop;
  fall.duration = duration;
  fall.rise_duration = rise;
  return fall;
}

TEST(SlipRule, FallMustBeSignificant) {
  EXPECT_TRUE(SlipRule{}.is_slip(fall_of(12.0), kSigma));
  EXPECT_FALSE(SlipRule{}.is_slip(fall_of(11.999), kSigma));
}

TEST(SlipRule, FallMustBeFastAgainstItsRise) {
  // 22 scans from above 90 % to below 10 % may have been 20, as many as the rise.
  EXPECT_TRUE(SlipRule{}.is_slip(fall_of(50.0, 22.0), kSigma));
  EXPECT_FALSE(SlipRule{}.is_slip(fall_of(50.0, 22.01), kSigma));
}

TEST(SlipRule, StickMustClimbWithoutFalling) {
  for (const auto& [drop_sigmas, slip] : {std::pair{30.1, true}, std::pair{29.9, false}}) {
    SlipRule rule;
    ASSERT_TRUE(rule.is_slip(fall_of(50.0, 3.0, 100.0), kSigma));
    EXPECT_FALSE(rule.is_slip(fall_of(10.0, 3.0, 120.0), kSigma));  // a fall on the way: 10 σ
    EXPECT_EQ(rule.is_slip(fall_of(drop_sigmas, 3.0, 140.0), kSigma), slip);
  }
}

TEST(SlipRule, RiseReachesBackOverInsignificantFalls) {
  // 30 scans of fall after a rise that a small fall divides into 20 + 20 scans: not slow.
  SlipRule rule;
  ASSERT_TRUE(rule.is_slip(fall_of(50.0, 4.0, 100.0), kSigma));  // ends at 105
  EXPECT_FALSE(rule.is_slip(fall_of(6.0, 1.0, 125.0), kSigma));
  EXPECT_TRUE(rule.is_slip(fall_of(50.0, 30.0, 145.0, 18.0), kSigma));
}

TEST(SlipRule, FallThatCountsStartsANewRiseEvenIfItIsNoSlip) {
  SlipRule rule;
  EXPECT_FALSE(rule.is_slip(fall_of(11.0, 3.0, 80.0), kSigma));
  EXPECT_FALSE(rule.is_slip(fall_of(20.0, 3.0, 100.0), kSigma));  // 11 > 20/3
  EXPECT_TRUE(rule.is_slip(fall_of(20.0, 3.0, 120.0), kSigma));   // nothing fell since
}

TEST(SlipRule, OnlyRatiosCount) {
  for (const double scale : {0x1p-40, 0x1p40}) {
    for (const double drop_sigmas : {11.9, 12.1}) {
      Fall fall = fall_of(drop_sigmas);
      const bool slip = SlipRule{}.is_slip(fall, kSigma);
      fall.robust_drop *= scale;
      EXPECT_EQ(SlipRule{}.is_slip(fall, kSigma * scale), slip);
    }
  }
}

}  // namespace
}  // namespace stickslip::detect
