#include "core/analysis/measured_speed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace stickslip::analysis {
namespace {

constexpr double kSpeedRate_Hz = 350.0;
constexpr double kStep_m_per_s = 20.0 / 65535.0 * 1e-3;  // 16 bits over ±10 V at 1 mm/s/V: 0.3 µm/s

/// What a channel of this step makes of v(t); noise on top, m/s.
MeasuredSpeed read(const std::function<double(double)>& speed, double duration_s, double noise_m_per_s,
                   unsigned seed) {
  std::mt19937 engine{seed};
  std::normal_distribution<double> noise{0.0, 1.0};
  MeasuredSpeed measured{MeasuredSpeed::resolution(noise_m_per_s, kStep_m_per_s)};
  for (int i = 0; i < static_cast<int>(duration_s * kSpeedRate_Hz); ++i) {
    const double t_s = i / kSpeedRate_Hz;
    const double v = speed(t_s) + noise_m_per_s * noise(engine);
    measured.add(t_s, std::round(v / kStep_m_per_s) * kStep_m_per_s);
  }
  return measured;
}

/// At rest for a second, at once at 2 mm/s, in a line to 8 mm/s at 7 s, at rest again.
double ramp(double t_s) { return t_s < 1.0 || t_s >= 7.0 ? 0.0 : 0.002 + 0.001 * (t_s - 1.0); }

TEST(MeasuredSpeed, RampIsALineWithinAStepOfTheTruth) {
  const auto course = read(ramp, 8.0, 0.0, 1).course();
  ASSERT_TRUE(course);
  // Rest, the jump within one scan, the ramp, the stop within one scan, rest: four bends, and each may take a
  // point more than it must.
  EXPECT_LE(course->points().size(), 10U);
  for (double t_s = 1.02; t_s < 6.98; t_s += 0.013) {
    // The mean of thousands of roundings, at worst one of them at the line's ends.
    EXPECT_NEAR(course->speed_m_per_s(t_s), ramp(t_s), kStep_m_per_s) << t_s;
    EXPECT_NEAR(course->acceleration_m_per_s2(t_s), 0.001, 1e-3 * 0.001) << t_s;
  }
  // What is less than the resolution is rest: one pull, from the jump to the stop, each within a scan.
  ASSERT_EQ(course->pulls().size(), 1U);
  EXPECT_NEAR(course->pulls()[0].start_s, 1.0, 1.01 / kSpeedRate_Hz);
  EXPECT_NEAR(course->pulls()[0].end_s, 7.0, 1.01 / kSpeedRate_Hz);
}

TEST(MeasuredSpeed, NoiseIsAveragedAway) {
  constexpr double kNoise_m_per_s = 20e-6;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const auto course = read(ramp, 8.0, kNoise_m_per_s, seed).course();
    ASSERT_TRUE(course);
    double squares = 0.0;
    int n = 0;
    for (double t_s = 1.1; t_s < 6.9; t_s += 0.013, ++n) {
      squares += std::pow(course->speed_m_per_s(t_s) - ramp(t_s), 2);
    }
    // Of 2100 readings a fit of two numbers leaves √(2/2100) of their noise on the average; of χ² with two
    // degrees of freedom one in 8000 is beyond 18, three times as much.
    EXPECT_LE(course->points().size(), 10U);
    EXPECT_LT(std::sqrt(squares / n), 3.0 * std::sqrt(2.0 / 2100.0) * kNoise_m_per_s);
  }
}

TEST(MeasuredSpeed, CurveIsFollowedWithinTheResolution) {
  const auto wave = [](double t_s) { return 0.005 + 0.002 * std::sin(2.0 * t_s); };
  const double resolution = MeasuredSpeed::resolution(0.0, kStep_m_per_s);
  const auto course = read(wave, 10.0, 0.0, 1).course();
  ASSERT_TRUE(course);
  for (double t_s = 0.0; t_s < 9.9; t_s += 0.0071) {
    // Lines keep to readings within the resolution, readings to the truth within half a step; least squares
    // move a line's end by less than it strays.
    EXPECT_NEAR(course->speed_m_per_s(t_s), wave(t_s), 2.0 * resolution + kStep_m_per_s) << t_s;
  }
}

TEST(MeasuredSpeed, BeltThatNeverPulledHasNoCourse) {
  EXPECT_FALSE(MeasuredSpeed{1e-6}.course());
  EXPECT_FALSE(read([](double) { return 0.0; }, 2.0, 1e-6, 3).course());
  EXPECT_FALSE(read([](double) { return -0.004; }, 2.0, 1e-6, 3).course());
}

}  // namespace
}  // namespace stickslip::analysis
