#include "core/analysis/slip_guess.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace stickslip::estimate {
namespace {

// A noisy pull whose first scan is a maximum, far above those around it: it looks loaded from rest, and there
// is no scan to take a slope from.
TEST(SlipGuess, TraceThatBeginsWithItsPeak) {
  constexpr double kScanRate_Hz = 350.0;
  constexpr double kScansPerPeriod = 20.0;
  Trace trace;
  for (std::size_t k = 0; k < 40; ++k) {
    const auto scan = static_cast<double>(k);
    trace.time_s.push_back(scan / kScanRate_Hz);
    trace.value.push_back(k == 0 ? 1.0 : 0.1 * std::cos(2.0 * std::numbers::pi * scan / kScansPerPeriod));
    trace.usable.push_back(1);
  }
  detect::Fall fall;
  fall.peak_at = 0.0;
  fall.peak = 1.0;
  fall.trough_at = 0.5 * kScansPerPeriod;
  fall.trough = -0.1;
  fall.rise_from = 1.0;
  const model::SharedParameters guess = analysis::first_guess(trace, std::vector{fall});
  EXPECT_NEAR(guess.omega, 2.0 * std::numbers::pi * kScanRate_Hz / kScansPerPeriod, 1e-9);
  EXPECT_EQ(guess.r, 0.0) << "no scan shows the stick";
}

}  // namespace
}  // namespace stickslip::estimate
