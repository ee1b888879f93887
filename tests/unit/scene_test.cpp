#include "core/sim/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "core/model/closed_forms.hpp"
#include "core/model/threshold.hpp"
#include "core/sim/scene_run.hpp"
#include "core/sim/scene_truth.hpp"
#include "tests/unit/scene_text.hpp"

namespace stickslip::sim {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::filesystem::path kScenes = std::filesystem::path(STICKSLIP_SOURCE_DIR) / "config" / "scenes";

/// Nine lines without any effect.
const std::string kBare = R"(description = "d"
duration = "1 s"
[tester]
sled_mass = "2331 g"
frequency = "20 Hz"
load_cell_gain = "2 N/V"
[paper]
mu_s = 0.35
mu_k = 0.30
)";
const std::string kNoise = "[effects.white_noise]\nsd = 0.001\n";
const std::string kConverter =
    "[effects.quantisation]\nbits = 12\nrange_min = \"0 V\"\nrange_max = \"5 V\"\n";

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  if (at == std::string::npos) throw std::logic_error("no " + what);
  return text.replace(at, what.size(), with);
}

/// The error's message, or "" if the scene is accepted.
std::vector<double> readings(const Scene& scene) {
  SceneRun run{scene, scene.scan_rate_Hz};
  std::vector<double> raw(static_cast<std::size_t>(scan_count(scene, scene.scan_rate_Hz)));
  EXPECT_EQ(run.next(raw), raw.size());
  return raw;
}

TEST(Scene, EffectsThatAreNotListedAreNotBuilt) {
  const auto effects = [](const std::string& text) {
    return SceneRun{*parse_scene(text, "t.toml"), 350.0}.effects();
  };
  EXPECT_THAT(effects(kBare), IsEmpty());
  EXPECT_THAT(effects(kBare + kNoise), ElementsAre("white_noise"));
  // In the order of the stages, however the file lists them.
  EXPECT_THAT(effects(kBare + kConverter + kNoise + "[effects.one_way_coupling]\n"),
              ElementsAre("one_way_coupling", "white_noise", "quantisation"));
}

TEST(Scene, WithoutEffectsNothingMovesAndReadingsAreVolts) {
  for (const double volts : readings(*parse_scene(kBare, "t.toml"))) EXPECT_EQ(volts, 0.0);
}

TEST(Scene, AddingAnEffectNeverChangesTheNumbersOfAnother) {
  const std::vector<double> noise = readings(*parse_scene(kBare + kNoise, "t.toml"));
  const std::vector<double> damped =
      readings(*parse_scene(kBare + kNoise + "[effects.damping]\ngamma_over_2omega = 0.022\n", "t.toml"));
  EXPECT_EQ(noise, damped);  // Nothing moves, so the readings are the noise itself.
  const std::vector<double> counts =
      readings(*parse_scene(kBare + kNoise + replaced(kConverter, "0 V", "-5 V"), "t.toml"));
  for (std::size_t i = 0; i < noise.size(); ++i) {
    EXPECT_NEAR(-5.0 + counts[i] * 10.0 / 4095.0, noise[i], 5.0 / 4095.0 + 1e-12);  // Half a step.
  }
}

TEST(Scene, NoiseHasTheSizeThatIsAskedForInAnyUnit) {
  const double load_N = 2.331 * 9.80665;
  for (const std::string& sd : {std::string("sd = 0.001"), fmt::format("sd_force = \"{} N\"", 0.001 * load_N),
                                fmt::format("sd_voltage = \"{} V\"", 0.001 * load_N / 2.0)}) {
    const Scene scene =
        *parse_scene(replaced(kBare, "1 s", "100 s") + "[effects.white_noise]\n" + sd + "\n", "t.toml");
    EXPECT_NEAR(scene.white_noise->sd_V, 0.001 * load_N / 2.0, 1e-15);
    double squares = 0.0;
    const std::vector<double> noise = readings(scene);
    for (const double volts : noise) squares += volts * volts;
    const double sd_V = std::sqrt(squares / static_cast<double>(noise.size()));
    // 35 000 numbers: 1/√(2n) = 0.4 %; five times that.
    EXPECT_NEAR(sd_V / scene.white_noise->sd_V, 1.0, 0.02);
  }
}

TEST(Scene, ConverterSaturatesAtItsRails) {
  const std::string text = kBare + kConverter;
  for (const auto& [zero, count] :
       {std::pair{"-1 V", 0.0}, {"0 V", 0.0}, {"2.5 V", 2048.0}, {"5 V", 4095.0}, {"9 V", 4095.0}}) {
    const std::string scene =
        replaced(text, "[paper]", fmt::format("load_cell_zero = \"{}\"\n[paper]", zero));
    EXPECT_EQ(readings(*parse_scene(scene, "t.toml")).front(), count) << zero;
  }
}

TEST(Scene, StiffnessAndFrequencyDescribeTheSameTester) {
  const double omega = 2.0 * std::acos(-1.0) * 20.0;
  const std::string damping = "[effects.damping]\ngamma_over_2omega = 0.022\n";
  const double stiffness = 2.331 * omega * omega * (1.0 + 0.022 * 0.022);  // k = m ω₀² [7]
  const Scene scene = *parse_scene(
      replaced(kBare, "frequency = \"20 Hz\"", fmt::format("stiffness = \"{} N/m\"", stiffness)) + damping,
      "t.toml");
  EXPECT_NEAR(scene.oscillator.omega_rad_per_s(), omega, 1e-12);
}

TEST(Scene, MistakesAreNamedWithPlaceValueAndLimit) {
  EXPECT_EQ(refusal_of(kBare), "");
  EXPECT_THAT(refusal_of(replaced(kBare, "mu_s = 0.35", "mu_s = 0.25")),
              AllOf(HasSubstr("test.toml:8"), HasSubstr("0.25"), HasSubstr("mu_k = 0.3")));
  EXPECT_THAT(refusal_of(replaced(kBare, "2331 g", "-2331 g")),
              AllOf(HasSubstr("test.toml:4"), HasSubstr("-2331 g")));
  EXPECT_THAT(refusal_of(replaced(kBare, "2331 g", "2331")),
              AllOf(HasSubstr("test.toml:4"), HasSubstr("unit")));
  EXPECT_THAT(refusal_of(replaced(kBare, "20 Hz", "0 Hz")), HasSubstr("test.toml:5"));
  EXPECT_THAT(refusal_of("scan_rate = \"0 Hz\"\n" + kBare),
              AllOf(HasSubstr("test.toml:1"), HasSubstr("0 Hz")));
  EXPECT_THAT(refusal_of(kBare + "[effects.witchcraft]\n"),
              AllOf(HasSubstr("test.toml:10"), HasSubstr("witchcraft"), HasSubstr("damping"),
                    HasSubstr("white_noise")));
  EXPECT_THAT(refusal_of(kBare + "[effects.white_noise]\nsd = 0.1\nsize = 3\n"), HasSubstr("size"));
  EXPECT_THAT(refusal_of(kBare + "[effects.white_noise]\n"), HasSubstr("sd"));
  EXPECT_THAT(refusal_of(kBare + "[effects.white_noise]\nsd = 0.1\nsd_voltage = \"1 V\"\n"),
              HasSubstr("sd_voltage"));
  EXPECT_THAT(refusal_of(kBare + replaced(kConverter, "5 V", "-5 V")), HasSubstr("range_min = 0"));
  EXPECT_THAT(refusal_of(kBare + replaced(kConverter, "12", "0")), HasSubstr("test.toml:11"));
  EXPECT_THAT(refusal_of(replaced(kBare, "duration = \"1 s\"\n", "")), HasSubstr("duration"));
  EXPECT_THAT(refusal_of(replaced(kBare, "frequency = \"20 Hz\"\n", "")), HasSubstr("frequency"));
  EXPECT_THAT(refusal_of(replaced(kBare, "frequency = \"20 Hz\"\n",
                                  "frequency = \"20 Hz\"\nstiffness = \"1 N/m\"\n")),
              HasSubstr("stiffness"));
  EXPECT_THAT(refusal_of("this is no TOML"), HasSubstr("test.toml:1"));
  const base::Result<Scene> missing = load_scene("/nonexistent/scene.toml");
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("/nonexistent/scene.toml"));
}

TEST(SceneTruth, ShippedRingDownRingsDown) {
  const base::Result<Scene> scene = load_scene(kScenes / "ring-down-at-12-in-per-min.toml");
  ASSERT_TRUE(scene) << scene.error().message;
  const model::TestTruth truth = scene_truth(*scene, scene->scan_rate_Hz, 1);
  EXPECT_EQ(truth.regime, model::Regime::kRingDown);
  EXPECT_NEAR(*truth.oscillation_frequency_Hz, 20.0, 1e-12);
  EXPECT_EQ(truth.cycles.size(), 1U);
  EXPECT_NEAR(truth.pull_speed_m_per_s, 0.00508, 1e-17);
  EXPECT_GT(
      scene->oscillator.stick_rate_per_s(0.00508, 9.80665) / (scene->oscillator.omega_rad_per_s() * 0.025),
      model::Q_threshold(0.022));
}

TEST(SceneTruth, ShippedStickSlipSticksAndSlips) {
  const base::Result<Scene> scene = load_scene(kScenes / "stick-slip-at-12-in-per-min.toml");
  ASSERT_TRUE(scene) << scene.error().message;
  const model::TestTruth truth = scene_truth(*scene, scene->scan_rate_Hz, 1);
  EXPECT_EQ(truth.regime, model::Regime::kStickSlip);
  EXPECT_GT(truth.cycles.size(), 90U);
  EXPECT_NEAR(*truth.oscillation_frequency_Hz, 19.3, 0.2);  // Table 1 less the damping.
  const double r = scene->oscillator.stick_rate_per_s(0.00508, 9.80665);
  const double Q = model::dimensionless_speed(r, truth.omega_rad_per_s, 0.05);
  EXPECT_NEAR(*truth.amplitude, 0.05 * model::amplitude_ratio(Q, 0.022), 1e-14);  // [17]
}

TEST(SceneTruth, ShippedThresholdOscillationIsOnItsEdge) {
  Scene scene = *load_scene(kScenes / "threshold-oscillation.toml");
  EXPECT_EQ(scene_truth(scene, 350.0, 1).regime, model::Regime::kStickSlip);
  scene.constant_speed->pull_speed_m_per_s *= 1.0 + 1e-9;
  EXPECT_EQ(scene_truth(scene, 350.0, 1).regime, model::Regime::kRingDown);
}

TEST(SceneTruth, ModesFollowEachOtherWithoutHoles) {
  const Scene scene = *load_scene(kScenes / "stick-slip-at-12-in-per-min.toml");
  const model::TestTruth truth = scene_truth(scene, scene.scan_rate_Hz, 1);
  ASSERT_GT(truth.modes.size(), 180U);
  EXPECT_EQ(truth.modes.front().start_s, 0.0);
  EXPECT_EQ(truth.modes.back().end_s, scene.duration_s);
  EXPECT_EQ(truth.modes.back().mode, model::Mode::kSlack);  // Returned further than the force.
  for (std::size_t i = 1; i < truth.modes.size(); ++i) {
    EXPECT_EQ(truth.modes[i].start_s, truth.modes[i - 1].end_s);
    EXPECT_LT(truth.modes[i].start_s, truth.modes[i].end_s);
  }
}

TEST(SceneTruth, TablesAreTheSameInAScratchFolder) {
  Scene scene = *load_scene(kScenes / "stick-slip-at-12-in-per-min.toml");
  scene.constant_speed->pull_s = 600.0;
  scene.duration_s = scene.constant_speed->duration_s();
  scene.clock_rate_error = ClockRateError{1e-4};
  const model::TestTruth expected = scene_truth(scene, scene.scan_rate_Hz, 1);
  const model::TestTruth truth =
      scene_truth(scene, scene.scan_rate_Hz, 1, {}, std::filesystem::temp_directory_path());
  // More than stay in memory.
  ASSERT_GT(truth.cycles.size(), truth.cycles.kResident * truth.cycles.kBlock);
  ASSERT_GT(truth.modes.size(), truth.modes.kResident * truth.modes.kBlock);
  ASSERT_EQ(truth.cycles.size(), expected.cycles.size());
  ASSERT_EQ(truth.modes.size(), expected.modes.size());
  for (std::size_t i = 0; i < truth.cycles.size(); ++i) {
    ASSERT_EQ(truth.cycles[i].onset_time_s, expected.cycles[i].onset_time_s);
    ASSERT_EQ(truth.cycles[i].mu_s, expected.cycles[i].mu_s);
    ASSERT_EQ(truth.cycles[i].mu_k, expected.cycles[i].mu_k);
  }
  for (std::size_t i = 0; i < truth.modes.size(); ++i) {
    ASSERT_EQ(truth.modes[i].start_s, expected.modes[i].start_s);
    ASSERT_EQ(truth.modes[i].end_s, expected.modes[i].end_s);
    ASSERT_EQ(truth.modes[i].mode, expected.modes[i].mode);
  }
  EXPECT_EQ(truth.regime, expected.regime);
  EXPECT_EQ(truth.oscillation_frequency_Hz, expected.oscillation_frequency_Hz);
}

TEST(SceneTruth, WithoutPullThereIsNoRegime) {
  const model::TestTruth truth = scene_truth(*parse_scene(kBare, "t.toml"), 350.0, 1);
  EXPECT_EQ(truth.regime, model::Regime::kUndecided);
  EXPECT_FALSE(truth.oscillation_frequency_Hz);
  EXPECT_FALSE(truth.amplitude);
}

}  // namespace
}  // namespace stickslip::sim
