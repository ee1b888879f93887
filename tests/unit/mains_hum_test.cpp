#include "core/sim/mains_hum.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "tests/unit/scene_text.hpp"

namespace stickslip::sim {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kHalfTurn_rad = std::numbers::pi;

/// Over one second of 350 scans, so that whole hertz are bins: amplitude and phase of a sine.
std::complex<double> sine_at(const std::vector<double>& volts, int frequency_Hz) {
  std::complex<double> sum;
  for (std::size_t i = 0; i < volts.size(); ++i) {
    const auto turns = static_cast<double>(static_cast<std::size_t>(frequency_Hz) * i % volts.size()) /
                       static_cast<double>(volts.size());
    sum += volts[i] * std::polar(1.0, -2.0 * kHalfTurn_rad * turns);
  }
  // a sin(ωt + p) leaves a/(2i) e^(ip) in its bin.
  return sum * std::complex<double>{0.0, 2.0} / static_cast<double>(volts.size());
}

TEST(MainsHum, HasTheAmplitudesAndPhasesAskedForAndNothingElse) {
  const std::vector<double> volts = readings_of(
      scene_at_rest() +
      "[effects.mains_hum]\nfrequency = \"60 Hz\"\namplitude_voltage = \"0.5 V\"\nphase = \"30 deg\"\n"
      "harmonics = [{ order = 2, share = 0.3, phase = \"-90 deg\" }, { order = 5, share = 0.1 }]\n");
  // Order 5 at 300 Hz appears as −50 Hz: a sine of the opposite phase at 50 Hz.
  for (int frequency_Hz = 1; frequency_Hz < 175; ++frequency_Hz) {
    std::complex<double> expected;
    if (frequency_Hz == 60) expected = std::polar(0.5, kHalfTurn_rad / 6.0);
    if (frequency_Hz == 120) expected = std::polar(0.15, -kHalfTurn_rad / 2.0);
    if (frequency_Hz == 50) expected = -0.05;
    // 350 terms below 1 V with a few ulp each.
    EXPECT_LT(std::abs(sine_at(volts, frequency_Hz) - expected), 1e-12) << frequency_Hz << " Hz";
  }
}

// 50 Hz at 350 scans/s repeats every 7 scans, after ten thousand years as at first.
TEST(MainsHum, KeepsItsPhaseForEver) {
  const MainsHum hum{50.0, 1.0, {{1, 1.0, 0.1}, {3, 0.5, 0.2}, {40, 0.1, 0.0}}};
  for (std::int64_t scan = 0; scan < 7; ++scan) {
    EXPECT_EQ(mains_hum_V(hum, 350.0, scan), mains_hum_V(hum, 350.0, scan + 7 * 15'000'000'000'000));
  }
}

// Numbers without a common period, beside mantissas of 64 bits: their product of frequency and index
// and their quotient are off by at most 2 · 2⁻⁶⁴ of the turns.
TEST(MainsHum, CyclesAreRightAtAnyIndexForAnyFrequency) {
  const double frequency_Hz = 59.97;
  const double rate_Hz = 350.0175;
  for (const std::int64_t scan : {1LL, 10LL, 12345LL, 987654321LL, 50'000'000'000LL}) {
    const long double turns = static_cast<long double>(frequency_Hz) * static_cast<long double>(scan) /
                              static_cast<long double>(rate_Hz);
    const auto expected = static_cast<double>(turns - std::floor(turns));
    EXPECT_NEAR(mains_cycles(frequency_Hz, rate_Hz, scan), expected,
                static_cast<double>(turns) * 0x1p-62 + 0x1p-52)
        << scan;
  }
}

TEST(MainsHum, MistakesAreNamedWithPlaceValueAndLimit) {
  const std::string scene = scene_at_rest() + "[effects.mains_hum]\n";
  EXPECT_THAT(refusal_of(scene), AllOf(HasSubstr("test.toml:12"), HasSubstr("amplitude_voltage")));
  EXPECT_THAT(refusal_of(scene + "amplitude = 0.1\nfrequency = \"0 Hz\"\n"),
              AllOf(HasSubstr("test.toml:14"), HasSubstr("0 Hz")));
  EXPECT_THAT(refusal_of(scene + "amplitude = 0.1\namplitude_force = \"1 N\"\n"),
              HasSubstr("amplitude_force"));
  EXPECT_THAT(refusal_of(scene + "amplitude = 0.1\nharmonics = [{ order = 1, share = 1 }]\n"),
              AllOf(HasSubstr("test.toml:14"), HasSubstr("from 2 to 40")));
}

}  // namespace
}  // namespace stickslip::sim
