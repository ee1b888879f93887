#include "core/detect/ring_down_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace stickslip::detect {
namespace {

constexpr double kRate_Hz = 350.0;
constexpr double kRingOmega = 40.0 * std::numbers::pi;
constexpr double kRingGamma = 5.0;
/// A period of 17.5 scans has whole ones, rounded half up.
constexpr int kScansInPeriod = 18;

/// A decaying oscillation of 0.05 about 0.3.
double ringing(int scan, double phase = 0.4) {
  const double time_s = scan / kRate_Hz;
  return 0.3 + 0.05 * std::exp(-0.5 * kRingGamma * time_s) * std::cos(kRingOmega * time_s + phase);
}

TEST(RingDownWatch, AmplitudeIsThatAtTheEndOfThePeriod) {
  RingDownWatch watch;
  watch.start(kRingOmega, kRingGamma, kRate_Hz);
  for (int period = 1; period <= 3; ++period) {
    std::optional<RingDownWatch::Amplitude> amplitude;
    for (int k = 0; k < kScansInPeriod; ++k) {
      ASSERT_FALSE(amplitude) << period;
      amplitude = watch.add(ringing((period - 1) * kScansInPeriod + k), true);
    }
    ASSERT_TRUE(amplitude) << period;
    const double end_s = period * kScansInPeriod / kRate_Hz;
    EXPECT_NEAR(amplitude->value, 0.05 * std::exp(-0.5 * kRingGamma * end_s), 1e-9) << period;
    EXPECT_FALSE(amplitude->is_over()) << period;
  }
}

// Scans that are missing or spikes only let time pass.
TEST(RingDownWatch, ScansThatAreNotUsableChangeNothing) {
  RingDownWatch watch;
  watch.start(kRingOmega, kRingGamma, kRate_Hz);
  std::optional<RingDownWatch::Amplitude> amplitude;
  for (int k = 0; k < kScansInPeriod; ++k) {
    const bool usable = k != 5 && k != 6;
    amplitude = watch.add(usable ? ringing(k) : 7.0, usable);
  }
  ASSERT_TRUE(amplitude);
  EXPECT_NEAR(amplitude->value, 0.05 * std::exp(-0.5 * kRingGamma * kScansInPeriod / kRate_Hz), 1e-9);
}

TEST(RingDownWatch, IsOverBelowThreeStandardErrors) {
  EXPECT_FALSE((RingDownWatch::Amplitude{3.01, 1.0}.is_over()));
  EXPECT_TRUE((RingDownWatch::Amplitude{2.99, 1.0}.is_over()));
}

}  // namespace
}  // namespace stickslip::detect
