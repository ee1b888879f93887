#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <vector>

#include "tests/support/sample_limits.hpp"
#include "tests/unit/scene_text.hpp"

namespace stickslip::sim {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;

std::string spikes(const std::string& rate, const std::string& size, const std::string& sizes) {
  return "[effects.spikes]\nrate = \"" + rate + "\"\n" + size + "\nsizes = \"" + sizes + "\"\n";
}

// Counts in equal windows are Poisson numbers, so Σ(n − m)²/m over w windows is χ² with w degrees of
// freedom to the order of 1/m. Outside of its 1e-6 quantiles the process is another one.
TEST(Spikes, ComeAsAPoissonProcess) {
  constexpr std::size_t kWindows = 200;
  constexpr std::size_t kScansPerWindow = 3500;
  constexpr double kMeanCount = 20.0;  // 2 a second for 10 s
  for (const std::string seed : {"1", "2", "3"}) {
    SCOPED_TRACE("seed " + seed);
    const std::vector<double> volts =
        readings_of("seed = " + seed + "\n" + scene_at_rest("2000 s") +
                    spikes("2 1/s", "mean_size_voltage = \"1 V\"", "exponential"));
    double chi_squared = 0.0;
    for (std::size_t window = 0; window < kWindows; ++window) {
      const auto first = volts.begin() + static_cast<std::ptrdiff_t>(window * kScansPerWindow);
      const auto count =
          std::count_if(first, first + kScansPerWindow, [](double value) { return value != 0.0; });
      chi_squared +=
          (static_cast<double>(count) - kMeanCount) * (static_cast<double>(count) - kMeanCount) / kMeanCount;
    }
    EXPECT_GT(chi_squared / kWindows, test::lowest_mean_square(kWindows, 1e-6));
    EXPECT_LT(chi_squared / kWindows, test::highest_mean_square(kWindows, 1e-6));
  }
}

TEST(Spikes, HaveTheSizesAskedForUpAndDownAlike) {
  struct Case {
    const char* sizes;
    double relative_sd;  // Of the size about its mean.
  };
  for (const auto& [sizes, relative_sd] :
       {Case{"fixed", 0.0}, {"uniform", 1.0 / std::sqrt(3.0)}, {"exponential", 1.0}}) {
    SCOPED_TRACE(sizes);
    std::vector<double> found =
        readings_of(scene_at_rest("20000 s") + spikes("1 1/s", "mean_size = 0.5", sizes));
    found.erase(std::remove(found.begin(), found.end(), 0.0), found.end());
    const auto count = static_cast<double>(found.size());
    double size = 0.0;
    double up = 0.0;
    for (const double volts : found) {
      size += std::abs(volts);
      up += volts > 0.0 ? 1.0 : 0.0;
    }
    // Five standard deviations of the mean, and 1/350 · ½ for two that fall into one scan.
    EXPECT_NEAR(size / count, 0.5, 0.5 * (5.0 * relative_sd / std::sqrt(count) + 0.5 / 350.0));
    EXPECT_NEAR(up / count, 0.5, 2.5 / std::sqrt(count));
  }
}

TEST(Spikes, LeaveTheScansBetweenThemAlone) {
  const std::string noise = "[effects.white_noise]\nsd = 0.001\n";
  const std::vector<double> plain = readings_of(scene_at_rest("100 s") + noise);
  const std::vector<double> spiky =
      readings_of(scene_at_rest("100 s") + noise + spikes("1 1/s", "mean_size = 0.5", "fixed"));
  std::size_t changed = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    if (spiky[i] == plain[i]) continue;
    ++changed;
    EXPECT_NEAR(std::abs(spiky[i] - plain[i]), 0.5, 1e-15);
  }
  EXPECT_NEAR(static_cast<double>(changed), 100.0, 50.0);  // Five standard deviations.
}

TEST(Spikes, SaturateTheConverter) {
  const std::vector<double> counts =
      readings_of(scene_at_rest("100 s") + spikes("1 1/s", "mean_size_voltage = \"20 V\"", "fixed") +
                  "[effects.quantisation]\nbits = 12\nrange_min = \"-10 V\"\nrange_max = \"10 V\"\n");
  EXPECT_GT(std::count(counts.begin(), counts.end(), 0.0), 10);
  EXPECT_GT(std::count(counts.begin(), counts.end(), 4095.0), 10);
  EXPECT_THAT(counts, Each(::testing::AnyOf(0.0, 2048.0, 4095.0)));
}

TEST(Spikes, AreTheSameHoweverTheScansAreDivided) {
  const Scene scene = scene_of(scene_at_rest("20 s") + spikes("30 1/s", "mean_size = 0.5", "exponential"));
  std::vector<double> whole(7000);
  SceneRun{scene, 350.0}.next(whole);
  SceneRun run{scene, 350.0};
  std::vector<double> divided;
  std::vector<double> part(13);
  while (const std::size_t count = run.next(part))
    divided.insert(divided.end(), part.begin(), part.begin() + static_cast<std::ptrdiff_t>(count));
  EXPECT_EQ(whole, divided);
}

TEST(Spikes, MistakesAreNamedWithPlaceValueAndLimit) {
  const std::string scene = scene_at_rest();
  // One spike a scan is the limit.
  EXPECT_THAT(refusal_of(scene + spikes("351 1/s", "mean_size = 0.5", "fixed")),
              AllOf(HasSubstr("test.toml:13"), HasSubstr("351 1/s"), HasSubstr("350")));
  EXPECT_THAT(refusal_of(scene + spikes("1 1/s", "", "fixed")), HasSubstr("mean_size_force"));
  EXPECT_THAT(refusal_of(scene + spikes("1 1/s", "mean_size = 0.5", "odd")),
              AllOf(HasSubstr("test.toml:15"), HasSubstr("odd"), HasSubstr("exponential")));
}

}  // namespace
}  // namespace stickslip::sim
