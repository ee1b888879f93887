#include "core/detect/fall_finder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <new>
#include <numbers>
#include <random>
#include <vector>

#include "tests/support/allocation_count.hpp"

namespace stickslip::detect {
namespace {

using std::numbers::pi;

std::vector<Fall> falls_in(const std::vector<double>& values, double hysteresis) {
  FallFinder finder;
  std::vector<Fall> falls;
  for (const double value : values) {
    if (const auto fall = finder.add(value, hysteresis)) falls.push_back(*fall);
  }
  return falls;
}

/// Rises by 1 for `rise` scans, then falls to 0 within `fall` scans; begins at 0.
std::vector<double> saw_tooth(int rise, int fall, int cycles) {
  std::vector<double> values;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    for (int k = 0; k < rise; ++k) values.push_back(k);
    for (int k = 0; k < fall; ++k) values.push_back(rise - static_cast<double>(rise) * k / fall);
  }
  for (int k = 0; k < rise; ++k) values.push_back(k);
  return values;
}

TEST(FallFinder, FindsEverySlipOfASawTooth) {
  for (const int fall : {1, 2, 4, 10}) {
    const int rise = 20;
    const int cycles = 300;
    const std::vector<Fall> falls = falls_in(saw_tooth(rise, fall, cycles), 3.0);
    ASSERT_EQ(falls.size(), static_cast<std::size_t>(cycles)) << fall;
    for (int i = 0; i < cycles; ++i) {
      const Fall& found = falls[static_cast<std::size_t>(i)];
      const double peak_at = i * (rise + fall) + rise;
      // The parabola through three scans moves an extreme by at most half a scan.
      EXPECT_NEAR(found.peak_at, peak_at, 0.5);
      EXPECT_NEAR(found.trough_at, peak_at + fall, 0.5);
      // At a corner between slopes a and −b it adds (a − b)²/(8(a + b)), below b/8 for a < b.
      EXPECT_GE(found.peak, rise);
      EXPECT_LE(found.peak, rise + static_cast<double>(rise) / fall / 8.0);
      EXPECT_LE(found.trough, 0.0);
      // 80 % of a straight fall, from scan to scan and through a median of three: two scans either way.
      EXPECT_NEAR(found.duration, 0.8 * fall, 2.0);
      EXPECT_NEAR(found.rise_duration, rise, 2.0);
      // The median of three cuts one scan off a corner: one step of the steeper side at each end.
      EXPECT_NEAR(found.robust_drop, rise, 2.0 * std::max(1.0, static_cast<double>(rise) / fall / 2.0));
    }
  }
}

TEST(FallFinder, NoiseThatStaysWithinTheHysteresisTurnsNothing) {
  std::mt19937_64 engine{1};
  std::uniform_real_distribution<double> uniform{-0.5, 0.5};
  std::vector<double> values(100'000);
  for (double& value : values) value = 0.3 + uniform(engine);
  EXPECT_TRUE(falls_in(values, 1.0).empty());
  EXPECT_FALSE(falls_in(values, 0.5).empty());  // the test can fail
}

TEST(FallFinder, GaussianNoiseMakesNoFallThatCouldBeASlip) {
  // A swing of 6 σ needs the running extremes to reach 3 σ on one side or more. A median of three
  // beyond 3 σ takes two of three scans: 3 · 0.00135² = 5.5e-6 a scan, 5.5 in a million. None can
  // reach the 12 σ of a slip.
  std::mt19937_64 engine{2};
  std::normal_distribution<double> normal{0.0, 1.0};
  std::vector<double> values(1'000'000);
  for (double& value : values) value = normal(engine);
  const std::vector<Fall> falls = falls_in(values, 6.0);
  EXPECT_LE(static_cast<double>(falls.size()), 5.5 + 4.0 * std::sqrt(5.5));
  for (const Fall& fall : falls) EXPECT_LT(fall.robust_drop, 8.0);
}

TEST(FallFinder, ParabolaThroughASampledCosine) {
  // With h = 2π/n and the maximum a part δ of a scan beside the largest scan, the vertex lies at
  // ½ tan(hδ) cot(h/2) (exact for a cosine), and is wrong by at most max|f‴| h³/(9√3), the error
  // of quadratic interpolation.
  const double n = 17.5;
  const double h = 2.0 * pi / n;
  const double bound = h * h * h / (9.0 * std::sqrt(3.0));
  for (int step = -24; step <= 24; ++step) {
    const double delta = step / 50.0;
    const double first_peak = 8.0 + delta;  // begins just after a minimum
    std::vector<double> values(60);
    for (std::size_t k = 0; k < values.size(); ++k) {
      values[k] = std::cos(h * (static_cast<double>(k) - first_peak));
    }
    const std::vector<Fall> falls = falls_in(values, 0.1);
    ASSERT_GE(falls.size(), 2U);
    const double vertex = 8.0 + 0.5 * std::tan(h * delta) / std::tan(h / 2.0);
    EXPECT_NEAR(falls[0].peak_at, vertex, 1e-12);
    for (const Fall& fall : falls) {
      EXPECT_NEAR(fall.peak, 1.0, bound);
      EXPECT_NEAR(fall.trough, -1.0, bound);
      // ½ tan(hδ) cot(h/2) − δ for |δ| ≤ ½ is at most 0.003 scans at n = 17.5.
      EXPECT_NEAR(fall.trough_at - fall.peak_at, n / 2.0, 0.006);
    }
  }
}

TEST(FallFinder, TraceThatBeginsAtItsMaximum) {
  std::vector<double> values(60);
  for (std::size_t k = 0; k < values.size(); ++k)
    values[k] = std::cos(2.0 * pi * static_cast<double>(k) / 20.0);
  const std::vector<Fall> falls = falls_in(values, 0.1);
  ASSERT_EQ(falls.size(), 3U);
  EXPECT_EQ(falls[0].peak_at, 0.0);
  EXPECT_EQ(falls[0].peak, 1.0);
  EXPECT_EQ(falls[0].rise_duration, 0.0);
  EXPECT_NEAR(falls[1].peak_at, 20.0, 1e-9);
}

TEST(FallFinder, TraceThatBeginsByFallingIsNoPeakInside) {
  // The same, after a plateau: the first scan of the largest value counts.
  std::vector<double> values(5, 1.0);
  for (int k = 1; k <= 10; ++k) values.push_back(1.0 - 0.1 * k);
  for (int k = 1; k <= 10; ++k) values.push_back(0.1 * k);
  const std::vector<Fall> falls = falls_in(values, 0.3);
  ASSERT_EQ(falls.size(), 1U);
  EXPECT_LE(falls[0].peak_at, 4.5);
  EXPECT_NEAR(falls[0].trough_at, 14.0, 0.5);
}

TEST(FallFinder, FlatTopsHaveTheirPeakOnTheFlat) {
  // Clipped at 0.8: acos(0.8)/2π of 20 scans is ±2.05 scans around each maximum.
  std::vector<double> values(200);
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] = std::min(0.8, std::cos(2.0 * pi * static_cast<double>(k) / 20.0 - pi));
  }
  const std::vector<Fall> falls = falls_in(values, 0.1);
  ASSERT_EQ(falls.size(), 9U);  // the tenth has not risen again
  // Beside the edge the parabola adds an eighth of the step before it: cos(2π·3/20) below 0.8.
  const double step = 0.8 - std::cos(2.0 * pi * 3.0 / 20.0);
  for (std::size_t i = 0; i < falls.size(); ++i) {
    EXPECT_NEAR(falls[i].peak_at, 10.0 + 20.0 * static_cast<double>(i), 2.5);
    EXPECT_GE(falls[i].peak, 0.8);
    EXPECT_LE(falls[i].peak, 0.8 + step / 8.0 + 1e-12);
  }
}

TEST(FallFinder, EveryPeakTheSame) {
  // One or two scans wide, amplitude of one step of the converter: found if it exceeds the hysteresis.
  std::vector<double> values;
  for (int cycle = 0; cycle < 50; ++cycle) values.insert(values.end(), {0.0, 0.0, 1.0, 1.0});
  EXPECT_EQ(falls_in(values, 0.5).size(), 49U);
  EXPECT_TRUE(falls_in(values, 1.0).empty());
}

TEST(FallFinder, SingleScanMakesNoTurningPoint) {
  std::vector<double> values(100, 0.0);
  values[50] = 100.0;
  EXPECT_TRUE(falls_in(values, 1.0).empty());
}

TEST(FallFinder, NeverAllocatesOnceItIsMade) {
  // An hour at 350 Hz of each: flat noise, in which nothing turns; one fall, without an end; sticks and
  // slips.
  constexpr int kScans = 3600 * 350;
  std::mt19937_64 engine{3};
  std::normal_distribution<double> normal{0.0, 1.0};
  const std::uint64_t none = test::allocation_count();
  ::operator delete(::operator new(sizeof(double)));
  EXPECT_GT(test::allocation_count(), none);  // the counter counts
  FallFinder finder;
  const std::uint64_t before = test::allocation_count();
  int falls = 0;
  for (int k = 0; k < kScans; ++k) (void)finder.add(normal(engine), 12.0);
  for (int k = 0; k < kScans; ++k) (void)finder.add(-k, 12.0);
  for (int k = 0; k < kScans; ++k) {
    if (finder.add(20.0 * (k % 20) + normal(engine), 12.0)) ++falls;
  }
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_GT(falls, kScans / 20 - 2);
}

TEST(FallFinder, KnowsHowLongNothingHasTurned) {
  FallFinder finder;
  for (const double value : saw_tooth(20, 4, 3)) (void)finder.add(value, 3.0);
  EXPECT_FALSE(finder.falling());
  const double before = finder.scans_since_turn();
  for (int k = 0; k < 100; ++k) (void)finder.add(19.0, 3.0);
  EXPECT_EQ(finder.scans_since_turn(), before + 100.0);
}

}  // namespace
}  // namespace stickslip::detect
