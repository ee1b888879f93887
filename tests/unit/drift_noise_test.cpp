#include "core/sim/drift_noise.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/sample_limits.hpp"
#include "tests/unit/scene_text.hpp"

namespace stickslip::sim {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kPi = std::numbers::pi;
constexpr double kRate_Hz = 350.0;
const DriftNoise kDrift{1.0, 0.001, 175.0};
const std::string kEffect = "[effects.drift_noise]\nsd_voltage = \"1 V\"\nlowest_frequency = \"0.001 Hz\"\n";

/// Slope of ln density against ln frequency, by least squares.
double slope(const std::vector<double>& frequency_Hz, const std::vector<double>& density) {
  double x = 0.0;
  double y = 0.0;
  double xx = 0.0;
  double xy = 0.0;
  for (std::size_t i = 0; i < density.size(); ++i) {
    const double u = std::log(frequency_Hz[i]);
    const double v = std::log(density[i]);
    x += u;
    y += v;
    xx += u * u;
    xy += u * v;
  }
  const auto n = static_cast<double>(density.size());
  return (n * xy - x * y) / (n * xx - x * x);
}

/// Mean one-sided periodogram under Hann's window, which keeps the strong low bins out of the others.
std::vector<double> density_of(const std::vector<double>& volts, std::size_t segment,
                               const std::vector<std::size_t>& bins) {
  std::vector<double> density;
  const auto length = static_cast<double>(segment);
  for (const std::size_t bin : bins) {
    double power = 0.0;
    for (std::size_t first = 0; first + segment <= volts.size(); first += segment) {
      std::complex<double> sum;
      for (std::size_t i = 0; i < segment; ++i) {
        const double window = 1.0 - std::cos(2.0 * kPi * static_cast<double>(i) / length);
        const double turns = static_cast<double>(bin * i % segment) / length;
        sum += volts[first + i] * window * std::polar(1.0, -2.0 * kPi * turns);
      }
      power += std::norm(sum);
    }
    const double segments = std::floor(static_cast<double>(volts.size()) / length);
    density.push_back(2.0 * power / segments / (kRate_Hz * length * 1.5));  // Mean square window: 3/2.
  }
  return density;
}

// The processes as documented: ripple 0.08 %, and one decade inside of the ends (0.01 Hz and 17.5 Hz)
// the density lacks (2/π) atan(1/10) = 6.3 %. Aliases add up to f/f_Nyquist there. Between 0.03 Hz and 5 Hz
// the ends take (2/π) atan(1/30) = 2.1 % and 1.8 %, over ln(167) = 5.1: a slope within 0.01 of −1.
TEST(DriftNoise, DensityOfTheProcessesIsOneOverF) {
  std::vector<double> frequency_Hz;
  std::vector<double> density;
  for (double f = 0.03; f < 5.0; f *= 1.1) {
    frequency_Hz.push_back(f);
    density.push_back(drift_density(kDrift, kRate_Hz, f));
  }
  EXPECT_NEAR(slope(frequency_Hz, density), -1.0, 0.01);
  // Each process has 1/11 of the variance; they are ln(175000)/10 apart.
  const double expected = 1.0 / 11.0 / (std::log(175000.0) / 10.0);
  for (std::size_t i = 0; i < density.size(); ++i) {
    EXPECT_NEAR(density[i] * frequency_Hz[i] / expected, 1.0, 0.03) << frequency_Hz[i] << " Hz";
  }
}

// One bin of one periodogram scatters by 100 %, so the mean over s segments by 1/√s. The bins are two
// or more apart, where Hann's window ties them together by no more than 1/36.
TEST(DriftNoise, ReadingsHaveTheDensityOfTheProcesses) {
  constexpr std::size_t kSegment = 8192;
  constexpr double kSegments = 64.0;
  const std::string seed = "seed = 11\n";
  SCOPED_TRACE(seed);
  const std::vector<double> volts = readings_of(seed + scene_at_rest("1498 s") + kEffect);
  std::vector<std::size_t> bins;
  for (std::size_t bin = 8; bin < 400; bin = bin * 5 / 4) bins.push_back(bin);  // 0.34 Hz … 17 Hz
  const std::vector<double> density = density_of(volts, kSegment, bins);
  std::vector<double> frequency_Hz;
  double spread = 0.0;
  double mean_log = 0.0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    frequency_Hz.push_back(kRate_Hz * static_cast<double>(bins[i]) / static_cast<double>(kSegment));
    mean_log += std::log(frequency_Hz[i]) / static_cast<double>(bins.size());
    const double expected = drift_density(kDrift, kRate_Hz, frequency_Hz[i]);
    EXPECT_NEAR(density[i] / expected, 1.0, 5.0 / std::sqrt(kSegments)) << frequency_Hz[i] << " Hz";
  }
  for (const double f : frequency_Hz) spread += (std::log(f) - mean_log) * (std::log(f) - mean_log);
  // Five standard deviations of a fitted slope, and 0.02 for the ends as above.
  EXPECT_NEAR(slope(frequency_Hz, density), -1.0, 5.0 / std::sqrt(kSegments * spread) + 0.02);
}

// Begun as if it had gone on for ever: the first scan scatters as much as any.
TEST(DriftNoise, IsStationaryFromTheFirstScan) {
  const Scene scene = scene_of(scene_at_rest() + kEffect);
  SceneRun run{scene, kRate_Hz};
  double squares = 0.0;
  constexpr int kRuns = 300;
  for (int seed = 0; seed < kRuns; ++seed) {
    run.restart(static_cast<std::uint64_t>(seed));
    double first = 0.0;
    run.next({&first, 1});
    squares += first * first;
  }
  EXPECT_LT(squares / kRuns, test::highest_mean_square(kRuns));
  EXPECT_GT(squares / kRuns, test::lowest_mean_square(kRuns));
}

TEST(DriftNoise, MistakesAreNamedWithPlaceValueAndLimit) {
  EXPECT_THAT(refusal_of(scene_at_rest() + kEffect + "highest_frequency = \"176 Hz\"\n"),
              AllOf(HasSubstr("test.toml:15"), HasSubstr("176 Hz"), HasSubstr("175 Hz")));
  EXPECT_THAT(refusal_of(scene_at_rest() + kEffect + "highest_frequency = \"0.005 Hz\"\n"),
              AllOf(HasSubstr("test.toml:15"), HasSubstr("10 times")));
}

TEST(SignalStage, ShippedSceneShowsAllOfIt) {
  const base::Result<Scene> scene =
      load_scene(std::filesystem::path(STICKSLIP_SOURCE_DIR) / "config/scenes/drift-hum-and-spikes.toml");
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT((SceneRun{*scene, kRate_Hz}.effects()),
              ::testing::IsSupersetOf({"drift_noise", "mains_hum", "spikes"}));
}

TEST(SignalStage, IsInTheOrderOfTheWires) {
  const std::string everything =
      "[effects.quantisation]\nbits = 12\nrange_min = \"-5 V\"\nrange_max = \"5 V\"\n"
      "[effects.spikes]\nrate = \"1 1/s\"\nmean_size = 0.1\n[effects.mains_hum]\namplitude = 0.1\n" +
      kEffect + "[effects.white_noise]\nsd = 0.1\n";
  EXPECT_THAT((SceneRun{scene_of(scene_at_rest() + everything), kRate_Hz}.effects()),
              ::testing::ElementsAre("white_noise", "drift_noise", "mains_hum", "spikes", "quantisation"));
}

// Each alone, and added to the others: the same numbers, but for the rounding of the sum.
TEST(SignalStage, EffectsAddUpWithoutKnowingOfEachOther) {
  const std::vector<std::string> effects{"[effects.white_noise]\nsd = 0.1\n", kEffect,
                                         "[effects.mains_hum]\namplitude = 0.1\n",
                                         "[effects.spikes]\nrate = \"1 1/s\"\nmean_size = 0.1\n"};
  std::vector<double> sum(3500, 0.0);
  std::string all = scene_at_rest("10 s");
  for (const std::string& effect : effects) {
    const std::vector<double> alone = readings_of(scene_at_rest("10 s") + effect);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += alone[i];
    all += effect;
  }
  const std::vector<double> together = readings_of(all);
  for (std::size_t i = 0; i < sum.size(); ++i) EXPECT_NEAR(together[i], sum[i], 1e-14);
}

}  // namespace
}  // namespace stickslip::sim
