// Friction laws beyond Coulomb's as scenes list them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "core/sim/scene_run.hpp"
#include "core/sim/scene_truth.hpp"
#include "core/sim/traditional_truth.hpp"
#include "tests/unit/scene_text.hpp"

namespace stickslip::sim {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

/// Twenty lines; the next table starts on line 21.
const std::string kShortPull = R"(description = "d"
seed = 11
accuracy = 1e-5
[tester]
sled_mass = "2331 g"
frequency = "20 Hz"
load_cell_gain = "2 N/V"
[paper]
mu_s = 0.35
mu_k = 0.30
[effects.damping]
gamma_over_2omega = 0.022
[effects.constant_speed]
idle = "0.1 s"
pull_speed = "6 in/min"
pull = "1.5 s"
stop = "0.2 s"
return_speed = "12 in/min"
return = "0.5 s"
rest = "0.1 s"
)";
const std::string kAgeing =
    "[effects.rate_and_state]\nlaw = \"ageing\"\na = 0.01\nb = 0.02\ncritical_slip = \"1 um\"\n"
    "reference_speed = \"1 um/s\"\n";

TEST(SceneLaws, VelocityDependenceAndStribeckMakeOneLaw) {
  const Scene scene = scene_of(kShortPull +
                               "[effects.velocity_dependence]\nper_speed = \"-0.5 s/m\"\n"
                               "[effects.stribeck]\nrise = 0.02\nspeed = \"1 mm/s\"\nexponent = 1\n");
  const Motion motion = motion_of(scene);
  ASSERT_TRUE(motion.velocity_dependence);
  EXPECT_EQ(motion.velocity_dependence->per_speed_s_per_m, -0.5);
  EXPECT_EQ(motion.velocity_dependence->stribeck_rise, 0.02);
  EXPECT_EQ(motion.velocity_dependence->stribeck_speed_m_per_s, 0.001);
  EXPECT_EQ(motion.velocity_dependence->stribeck_exponent, 1.0);
  const SceneRun run{scene, 350.0};
  EXPECT_THAT(run.effects(), AllOf(Contains("velocity_dependence"), Contains("stribeck")));
  EXPECT_EQ(run.method().name, "SUNDIALS CVODE (Adams)");
  EXPECT_EQ(run.method().accuracy, 1e-5);
  EXPECT_EQ(SceneRun(scene_of(kShortPull), 350.0).method().name, "exact closed forms");
}

TEST(SceneLaws, RateAndStateIsReadWithItsUnits) {
  const Scene scene = scene_of(kShortPull + kAgeing);
  const Motion motion = motion_of(scene);
  ASSERT_TRUE(motion.rate_and_state);
  EXPECT_EQ(motion.rate_and_state->law, RateAndState::Law::kAgeing);
  EXPECT_EQ(motion.rate_and_state->critical_slip_m, 1e-6);
  EXPECT_EQ(motion.rate_and_state->reference_speed_m_per_s, 1e-6);
  EXPECT_EQ(motion.rate_and_state->mu_0, 0.30);  // mu_k
  EXPECT_EQ(SceneRun(scene, 350.0).method().name, "SUNDIALS CVODE (BDF)");
}

TEST(SceneLaws, RateAndStateHasATruth) {
  const model::TestTruth truth = scene_truth(scene_of(kShortPull + kAgeing), 350.0, 1);
  EXPECT_EQ(truth.regime, model::Regime::kStickSlip);
  ASSERT_GT(truth.cycles.size(), 5U);
  for (const model::TrueCycle& cycle : truth.cycles) {
    EXPECT_GT(cycle.mu_s, cycle.mu_k);
    EXPECT_LT(cycle.mu_s, 0.6);
  }
  ASSERT_TRUE(truth.static_coefficient && truth.kinetic_coefficient);
  // S is the coefficient at the onset; the force goes on to its maximum right after.
  EXPECT_NEAR(*truth.static_coefficient, truth.cycles[0].mu_s, 0.01);
  EXPECT_LT(*truth.kinetic_coefficient, *truth.static_coefficient);
  ASSERT_TRUE(truth.amplitude && truth.oscillation_frequency_Hz);
  EXPECT_GT(*truth.amplitude, truth.cycles[0].mu_s - truth.cycles[0].mu_k);
  EXPECT_NEAR(*truth.oscillation_frequency_Hz, 14.0, 6.0);
}

// What the results are compared with: a contact that has rested as long as those of the test, a sled that
// slides at its speed.
TEST(SceneLaws, TruthIsTheMeanOfTheSlipsBehindTheFirst) {
  for (const std::string law : {"[effects.contact_ageing]\nper_decade = 0.02\n",
                                "[effects.kinetic_drift]\nchange = -0.1\nover = \"1 s\"\n"}) {
    const model::TestTruth truth = scene_truth(scene_of(kShortPull + law), 350.0, 1);
    ASSERT_GT(truth.cycles.size(), 5U);
    std::vector<double> S;
    std::vector<double> K;
    for (const model::TrueCycle& cycle : truth.cycles) {
      S.push_back(cycle.mu_s);
      K.push_back(cycle.mu_k);
    }
    const auto mean = [](const std::vector<double>& of) {
      return std::accumulate(of.begin() + 1, of.end(), 0.0) / static_cast<double>(of.size() - 1);
    };
    EXPECT_NEAR(truth.mu_s, mean(S), 1e-12);
    EXPECT_NEAR(truth.mu_k, mean(K), 1e-12);
    EXPECT_GT(std::abs(truth.mu_s - 0.35), 0.001);
  }
}

TEST(SceneLaws, TrueKineticCoefficientIsThatAtTheSpeedOfThePull) {
  const std::string slope = "[effects.velocity_dependence]\nper_speed = \"-0.2 s/m\"\n";
  const model::TestTruth linear = scene_truth(scene_of(kShortPull + slope), 350.0, 1);
  EXPECT_NEAR(linear.mu_k, 0.30 - 0.2 * linear.pull_speed_m_per_s, 1e-12);
  const std::string stribeck = "[effects.stribeck]\nrise = 0.04\nspeed = \"5 mm/s\"\nexponent = 1\n";
  const model::TestTruth curved = scene_truth(scene_of(kShortPull + stribeck), 350.0, 1);
  EXPECT_NEAR(curved.mu_k, 0.30 + 0.04 * std::exp(-curved.pull_speed_m_per_s / 0.005), 1e-12);
  EXPECT_NEAR(curved.mu_s, 0.35, 1e-12);
}

// The carriage of a tester pulls either way; the law asks for the speed of sliding.
TEST(SceneLaws, TrueKineticCoefficientIsThatOfABeltThatGoesBack) {
  const std::string begin =
      "duration = \"2 s\"\n" + kShortPull.substr(0, kShortPull.find("[effects.constant_speed]"));
  const auto truth_at = [&](const std::string& speed) {
    return scene_truth(
        scene_of(begin + "[effects.piecewise_speed]\npoints = [{at = \"0.1 s\", speed = \"" + speed +
                 "\"}, {at = \"2 s\", speed = \"" + speed +
                 "\"}]\n[effects.stribeck]\nrise = 0.04\nspeed = \"5 mm/s\"\nexponent = 1.5\n"),
        350.0, 1);
  };
  const double K = 0.30 + 0.04 * std::exp(-std::pow(4.0 / 5.0, 1.5));
  EXPECT_NEAR(truth_at("4 mm/s").mu_k, K, 1e-12);
  EXPECT_NEAR(truth_at("-4 mm/s").mu_k, K, 1e-12);
}

// Each contact is another one; what the results are uncertain about is the paper.
TEST(SceneLaws, TruthOfContactsThatScatterIsThePaper) {
  const model::TestTruth truth =
      scene_truth(scene_of(kShortPull + "[effects.scatter]\ndelta_mu_cv = 0.2\nmu_k_sd = 0.004\n"), 350.0, 1);
  ASSERT_GT(truth.cycles.size(), 5U);
  EXPECT_EQ(truth.mu_s, 0.35);
  EXPECT_EQ(truth.mu_k, 0.30);
}

// A contact that has rested for long is stronger; the results are of the slips between the holds.
TEST(SceneLaws, TruthIsWithoutTheSlipsAfterHolds) {
  const auto folder = std::filesystem::path(STICKSLIP_SOURCE_DIR) / "config/scenes";
  const auto scene = load_scene(folder / "slide-hold-slide.toml");
  ASSERT_TRUE(scene);
  const model::TestTruth truth = scene_truth(*scene, 350.0, 1);
  double largest = 0.0;
  for (const model::TrueCycle& cycle : truth.cycles) largest = std::max(largest, cycle.mu_s);
  std::vector<double> S;
  for (const model::TrueCycle& cycle : truth.cycles) S.push_back(cycle.mu_s);
  std::ranges::sort(S);
  // Half of the slips follow short rests; those after holds lie far above.
  EXPECT_GT(largest, S[S.size() / 2] + 0.01);
  EXPECT_NEAR(truth.mu_s, S[S.size() / 2], 0.0005);
}

// a > b: no stick-slip at any speed.
TEST(SceneLaws, StrengtheningRateAndStateSlidesOnceAndForAll) {
  const std::string law =
      "[effects.rate_and_state]\nlaw = \"slip\"\na = 0.02\nb = 0.01\ncritical_slip = \"1 um\"\n"
      "reference_speed = \"1 um/s\"\n";
  const model::TestTruth truth = scene_truth(scene_of(kShortPull + law), 350.0, 1);
  EXPECT_EQ(truth.regime, model::Regime::kRingDown);
}

// The transducers see the same force as the scans: a load cell far above the motion changes little.
// A solver goes to the scan behind the end, a numeric one further.
TEST(SceneLaws, TruthEndsWithTheScene) {
  for (const std::string& law : {std::string{}, kAgeing}) {
    Scene scene = scene_of(kShortPull + law);
    const double onset_s = scene_truth(scene, 350.0, 11).cycles[1].onset_time_s;
    for (const double early_s : {1e-6, 1e-3}) {
      scene.duration_s = onset_s - early_s;
      const model::TestTruth truth = scene_truth(scene, 350.0, 11);
      EXPECT_EQ(truth.cycles.size(), 1U) << law << early_s;
      ASSERT_FALSE(truth.modes.empty());
      EXPECT_EQ(truth.modes[truth.modes.size() - 1].end_s, scene.duration_s) << law << early_s;
    }
  }
}

// The first peak comes atan(Q)/ω after the onset: in a pull as slow as this one 16 of 2000 points in a
// period. A mean that ends 8 points after the pull, counted from the onset, has 24 too few.
TEST(SceneLaws, TraditionalCoefficientsReadNothingAfterThePull) {
  Scene scene = scene_of(kShortPull);
  scene.constant_speed->pull_speed_m_per_s = 2e-4;
  const double points_per_s = 2000.0 * scene.oscillator.omega_rad_per_s() / (2.0 * std::numbers::pi);
  const double onset_s = scene_truth(scene, 350.0, 11).cycles[0].onset_time_s;
  model::Method method;
  for (int i = 0; i < 4; ++i) {  // The end lies anywhere in a block of points.
    const double length_s = pull_of(scene)->end_s - onset_s;
    const auto to = [&](double points) {
      method.kinetic_travel = model::TravelWindow{0.0, 2e-4 * (length_s + points / points_per_s)};
      return traditional_truth(scene, 11, onset_s, method, 2e-4).kinetic_coefficient;
    };
    EXPECT_TRUE(to(-50.0));
    EXPECT_FALSE(to(8.0));
    scene.constant_speed->pull_s += 0.0013;
  }
}

TEST(SceneLaws, TransducersFollowANumericMotion) {
  const std::string law = "[effects.stribeck]\nrise = 0.03\nspeed = \"1 mm/s\"\n";
  const std::vector<double> bare = readings_of(kShortPull + law);
  const std::vector<double> seen =
      readings_of(kShortPull + law + "[effects.load_cell]\nfrequency = \"20 kHz\"\ndamping_ratio = 0.7\n");
  ASSERT_EQ(bare.size(), seen.size());
  const double volts = 2.331 * 9.80665 / 2.0;
  // Behind by 2ζ/ω = 11 µs, at no more than 20/s; and twice the accuracy.
  for (std::size_t i = 0; i < bare.size(); ++i) ASSERT_NEAR(seen[i], bare[i], (20 * 1.2e-5 + 2e-5) * volts);
}

TEST(SceneLaws, MistakesAreNamed) {
  EXPECT_EQ(refusal_of(kShortPull + kAgeing), "");
  EXPECT_THAT(refusal_of(kShortPull + "[effects.velocity_dependence]\n"), HasSubstr("per_speed"));
  EXPECT_THAT(refusal_of(kShortPull + "[effects.velocity_dependence]\nper_speed = 0.5\n"),
              AllOf(HasSubstr("test.toml:22"), HasSubstr("s/m")));
  EXPECT_THAT(refusal_of(kShortPull + "[effects.stribeck]\nrise = 0.06\nspeed = \"1 mm/s\"\n"),
              AllOf(HasSubstr("test.toml:22"), HasSubstr("0.06"), HasSubstr("mu_s - mu_k")));
  EXPECT_THAT(refusal_of(kShortPull + "[effects.stribeck]\nrise = 0.01\nspeed = \"0 m/s\"\n"),
              HasSubstr("test.toml:23"));
  EXPECT_THAT(refusal_of(kShortPull + "[effects.rate_and_state]\nlaw = \"ruina\"\n"),
              AllOf(HasSubstr("ageing"), HasSubstr("slip")));
  EXPECT_THAT(refusal_of(kShortPull + kAgeing + "mu_0 = -1\n"), HasSubstr("test.toml:27"));
}

TEST(SceneLaws, RateAndStateStandsAlone) {
  for (const std::string other :
       {"[effects.scatter]\ndelta_mu_cv = 0.3\n", "[effects.first_peak]\nchange = 0.01\n",
        "[effects.contact_ageing]\nper_decade = 0.01\n",
        "[effects.velocity_dependence]\nper_speed = \"1 s/m\"\n",
        "[effects.stribeck]\nrise = 0.01\nspeed = \"1 mm/s\"\n",
        "[effects.onset_convention]\nforce = \"spring\"\n"}) {
    EXPECT_THAT(refusal_of(fmt::format("{}{}{}", kShortPull, kAgeing, other)),
                AllOf(HasSubstr("test.toml:27"), HasSubstr("rate_and_state")))
        << other;
  }
}

}  // namespace
}  // namespace stickslip::sim
