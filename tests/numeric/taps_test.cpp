#include "core/analysis/taps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "tests/support/sample_limits.hpp"

namespace stickslip::analysis {
namespace {

struct Bench {
  double frequency_Hz = 120.0;
  double damping_ratio = 0.05;
  double rate_Hz = 2000.0;
  double contact_s = 0.004;  ///< A half-sine of force: what taps the cell stays as long.
  double noise = 0.001;
  double force = 0.3;
  double level = 0.02;
  double drift_per_s = 0.0;
};

/// Readings of y″ + 2ζω y′ + ω² y = ω² x for a tap every 0.7 s, by Runge and
/// Kutta's method in fine steps: nothing of what is tested.
std::vector<double> tapped(const Bench& bench, int taps, std::mt19937_64& random) {
  constexpr int kSteps = 64;
  constexpr double kEvery_s = 0.7;
  const double omega = 2.0 * std::numbers::pi * bench.frequency_Hz;
  const double h = 1.0 / bench.rate_Hz / kSteps;
  const double phase_s = std::uniform_real_distribution<double>{0.0, 1.0 / bench.rate_Hz}(random);
  const auto force = [&](double t) {
    const double since = std::fmod(t - phase_s, kEvery_s);
    return t > kEvery_s && since < bench.contact_s
               ? bench.force * std::sin(std::numbers::pi * since / bench.contact_s)
               : 0.0;
  };
  const auto rate = [&](double t, double y, double v) {
    return omega * omega * (force(t) - y) - 2.0 * bench.damping_ratio * omega * v;
  };
  std::normal_distribution<double> noise{bench.level, bench.noise};
  std::vector<double> read;
  double y = 0.0;
  double v = 0.0;
  long step = 0;
  const auto scans = static_cast<long>((taps + 1) * kEvery_s * bench.rate_Hz);
  for (long scan = 0; scan < scans; ++scan) {
    read.push_back(y + noise(random) + bench.drift_per_s * static_cast<double>(scan) / bench.rate_Hz);
    for (int i = 0; i < kSteps; ++i, ++step) {
      const double t = static_cast<double>(step) * h;
      const double a1 = rate(t, y, v);
      const double a2 = rate(t + 0.5 * h, y + 0.5 * h * v, v + 0.5 * h * a1);
      const double a3 = rate(t + 0.5 * h, y + 0.5 * h * (v + 0.5 * h * a1), v + 0.5 * h * a2);
      const double a4 = rate(t + h, y + h * (v + 0.5 * h * a2), v + h * a3);
      y += h * (v + h / 6.0 * (a1 + a2 + a3));
      v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
  }
  return read;
}

CellEstimate pooled(const Taps& taps) {
  std::vector<TesterEstimate> rings;
  for (const Tap& tap : taps.taps) rings.push_back(tap.ring);
  const auto mean = pool_ring_downs(rings);
  return mean ? cell_of(mean->coupling) : CellEstimate{};
}

TEST(Taps, TellTheCellsNaturalFrequencyAndDampingWithinTheirErrors) {
  std::mt19937_64 random{20261129};
  constexpr int kTests = 16;
  for (const Bench& bench :
       {Bench{}, Bench{.frequency_Hz = 60.0, .rate_Hz = 350.0},
        Bench{.frequency_Hz = 120.0, .damping_ratio = 0.02, .rate_Hz = 350.0},
        Bench{.frequency_Hz = 80.0, .damping_ratio = 0.3}, Bench{.contact_s = 0.012, .drift_per_s = 0.007}}) {
    SCOPED_TRACE(testing::Message() << bench.frequency_Hz << " Hz, damping " << bench.damping_ratio << ", "
                                    << bench.rate_Hz << " scans/s, seed 20261129");
    double frequency_square = 0.0;
    double damping_square = 0.0;
    for (int test = 0; test < kTests; ++test) {
      const Taps found = find_taps(tapped(bench, 2, random), bench.rate_Hz);
      ASSERT_EQ(found.taps.size(), 2U);
      const CellEstimate cell = pooled(found);
      ASSERT_TRUE(cell.frequency_Hz.value && cell.damping_ratio.value);
      frequency_square +=
          std::pow((*cell.frequency_Hz.value - bench.frequency_Hz) / *cell.frequency_Hz.standard_error, 2);
      damping_square +=
          std::pow((*cell.damping_ratio.value - bench.damping_ratio) / *cell.damping_ratio.standard_error, 2);
    }
    EXPECT_LT(frequency_square / kTests, test::highest_mean_square(kTests));
    EXPECT_LT(damping_square / kTests, test::highest_mean_square(kTests));
    // Errors are enlarged where taps disagree by chance, never reduced: by less than twofold in the mean.
    EXPECT_GT(frequency_square / kTests, test::lowest_mean_square(kTests) / 2.0);
    EXPECT_GT(damping_square / kTests, test::lowest_mean_square(kTests) / 2.0);
  }
}

TEST(Taps, AreFoundAtTheirTimesAndNowhereInNoise) {
  std::mt19937_64 random{1};
  const Bench bench;
  const std::vector<double> read = tapped(bench, 3, random);
  const Taps found = find_taps(read, bench.rate_Hz);
  ASSERT_EQ(found.taps.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(found.taps[i].at_s, 0.7 * static_cast<double>(i + 1), 0.01) << i;
  const std::size_t before = read.size() / 5;
  EXPECT_TRUE(find_taps(std::span{read}.first(before), bench.rate_Hz).taps.empty());
  EXPECT_TRUE(find_taps(std::vector<double>(1000, 0.25), bench.rate_Hz).taps.empty());
  EXPECT_TRUE(find_taps({}, bench.rate_Hz).taps.empty());
  std::vector<double> at_the_end{read.begin(), read.begin() + static_cast<std::ptrdiff_t>(before)};
  at_the_end.back() = 1.0;
  EXPECT_EQ(find_taps(at_the_end, bench.rate_Hz).refused.size(), 1U);
}

TEST(Taps, OfACellAboveHalfTheScanRateShowItsAlias) {
  std::mt19937_64 random{2};
  const Bench bench{.frequency_Hz = 210.0, .damping_ratio = 0.02, .rate_Hz = 350.0};
  const CellEstimate cell = pooled(find_taps(tapped(bench, 3, random), bench.rate_Hz));
  ASSERT_TRUE(cell.frequency_Hz.value);
  EXPECT_NEAR(*cell.frequency_Hz.value, 140.0, 0.5);
  EXPECT_NEAR(alias_Hz(*cell.frequency_Hz.value, bench.rate_Hz), bench.frequency_Hz, 0.5);
}

// Beyond 4000 readings a second neighbours are averaged.
TEST(Taps, AreOneEachHoweverFastTheScan) {
  std::mt19937_64 random{6};
  const Bench bench{.rate_Hz = 20'000.0};
  const Taps found = find_taps(tapped(bench, 2, random), bench.rate_Hz);
  EXPECT_EQ(found.taps.size(), 2U);
  EXPECT_TRUE(found.refused.empty());
  const CellEstimate cell = pooled(found);
  ASSERT_TRUE(cell.frequency_Hz.value);
  EXPECT_LT(std::abs(*cell.frequency_Hz.value - 120.0), 4.0 * *cell.frequency_Hz.standard_error);
}

TEST(Taps, OfWhichAnotherOscillationDiesSoonerTellTheOneThatLasts) {
  std::mt19937_64 random{3};
  const std::vector<double> one = tapped({}, 3, random);
  const std::vector<double> other = tapped({.frequency_Hz = 170.0, .noise = 0.0, .level = 0.0}, 3, random);
  std::vector<double> both(one.size());
  std::ranges::transform(one, other, both.begin(), std::plus{});
  const CellEstimate cell = pooled(find_taps(both, 2000.0));
  ASSERT_TRUE(cell.frequency_Hz.value);
  EXPECT_LT(std::abs(*cell.frequency_Hz.value - 120.0), 4.0 * *cell.frequency_Hz.standard_error);
}

TEST(Taps, ThatPushInsteadAreRefusedWithTheirTimes) {
  std::mt19937_64 random{4};
  std::normal_distribution<double> noise{0.02, 0.001};
  std::vector<double> pushed(4000);
  for (std::size_t k = 0; k < pushed.size(); ++k) {
    const double since = std::fmod(static_cast<double>(k), 1000.0) - 500.0;
    pushed[k] =
        noise(random) +
        (since > 0.0 && since < 200.0 ? std::pow(std::sin(std::numbers::pi * since / 200.0), 2) : 0.0);
  }
  const Taps found = find_taps(pushed, 2000.0);
  EXPECT_TRUE(found.taps.empty());
  ASSERT_EQ(found.refused.size(), 4U);
  EXPECT_NEAR(found.refused.front().at_s, 0.3, 0.005);
  EXPECT_NE(found.refused.front().why.find("not one decaying oscillation"), std::string::npos);
}

TEST(Taps, WeightThatStaysOnTheCellIsNone) {
  std::mt19937_64 random{5};
  std::normal_distribution<double> noise{0.02, 0.001};
  std::vector<double> loaded(6'000);
  for (std::size_t k = 0; k < loaded.size(); ++k) loaded[k] = noise(random) + (k < 3500 ? 0.0 : 1.0);
  const Taps found = find_taps(loaded, 2000.0);
  EXPECT_TRUE(found.taps.empty());
  ASSERT_EQ(found.refused.size(), 1U);
  EXPECT_GE(found.refused.front().at_s, 1.75);
}

}  // namespace
}  // namespace stickslip::analysis
