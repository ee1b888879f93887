/// The shipped scenes, many times over: are the words right, and do the standard errors tell how
/// far the numbers are from the truth?
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/support/sample_limits.hpp"
#include "tests/support/scene_tests.hpp"

namespace stickslip {
namespace {

using analysis::Estimate;
using model::Regime;
using Event = pipeline::Segmenter::Event;

constexpr int kRepeats = 300;
/// [effects.constant_speed] idle of both scenes at 350 Hz.
constexpr base::ScanIndex kIdleScans = 175;
/// One repetition: 0.5 + 5 + 1 + 0.5 + 1 s.
constexpr base::ScanIndex kSceneScans = 2800;

const std::vector<test::AnalysedTest>& tests_of(const std::string& scene) {
  static std::map<std::string, std::vector<test::AnalysedTest>> known;
  auto found = known.find(scene);
  if (found == known.end()) {
    const auto file = std::filesystem::path(STICKSLIP_SOURCE_DIR) / "config/scenes" / (scene + ".toml");
    found = known.emplace(scene, test::analyse_scene(file, kRepeats)).first;
  }
  return found->second;
}

struct DemoScene {
  std::string name;
  Regime regime = Regime::kUndecided;
  Event ended_by = Event::kNone;
};

class DemoScenes : public testing::TestWithParam<DemoScene> {
 protected:
  [[nodiscard]] const std::vector<test::AnalysedTest>& tests() const { return tests_of(GetParam().name); }
};

TEST_P(DemoScenes, EveryRepetitionIsOneTestWithTheRightRegime) {
  ASSERT_EQ(tests().size(), static_cast<std::size_t>(kRepeats));
  for (const test::AnalysedTest& test : tests()) {
    ASSERT_TRUE(test.truth);
    EXPECT_EQ(test.truth->regime, GetParam().regime);
    EXPECT_EQ(test.results.regime, GetParam().regime) << test.results.regime_reason;
  }
}

TEST_P(DemoScenes, TestEndsAsItDid) {
  for (const test::AnalysedTest& test : tests()) EXPECT_EQ(test.ended_by, GetParam().ended_by);
}

TEST_P(DemoScenes, TestBeginsWithinAFewScansOfThePull) {
  // The force rises at the rate r and reaches the trigger of 0.05 after 0.05/r; then the dwell of 4 scans.
  for (std::size_t i = 0; i < tests().size(); ++i) {
    const test::AnalysedTest& test = tests()[i];
    const base::ScanIndex pull = static_cast<base::ScanIndex>(i) * kSceneScans + kIdleScans;
    const double r = test.truth->omega_rad_per_s * test.truth->omega_rad_per_s * (1.0 + 0.022 * 0.022) *
                     test.truth->pull_speed_m_per_s / 9.80665;
    const auto climb = static_cast<base::ScanIndex>(std::ceil(0.05 / r * 350.0));
    EXPECT_GE(test.trigger, pull + 3);
    EXPECT_LE(test.trigger, pull + climb + 4);
    EXPECT_EQ(test.first, test.trigger - 88);  // 0.25 s before
  }
}

TEST_P(DemoScenes, StandardErrorsTellTheDistanceFromTheTruth) {
  // z = (value − truth)/standard error is a standard normal number, but for the standard errors, which
  // scatter from test to test: 5 % of the variance. (Of 1000 repetitions all ten variances were 0.95
  // to 1.06.)
  struct Compared {
    const char* what;
    Estimate analysis::TestResults::*estimate;
    double (*truth)(const model::TestTruth&);
  };
  const std::vector<Compared> compared{
      {"mu_s", &analysis::TestResults::mu_s, [](const model::TestTruth& t) { return t.mu_s; }},
      {"mu_k", &analysis::TestResults::mu_k, [](const model::TestTruth& t) { return t.mu_k; }},
      {"delta_mu", &analysis::TestResults::delta_mu,
       [](const model::TestTruth& t) { return t.mu_s - t.mu_k; }},
      {"omega", &analysis::TestResults::omega, [](const model::TestTruth& t) { return t.omega_rad_per_s; }},
      {"gamma_over_2omega", &analysis::TestResults::gamma_over_2omega,
       [](const model::TestTruth& t) { return t.gamma_over_2omega; }},
  };
  for (const auto& [what, estimate, truth] : compared) {
    double sum = 0.0;
    double squares = 0.0;
    double square_error_sum = 0.0;
    for (const test::AnalysedTest& test : tests()) {
      const Estimate& found = test.results.*estimate;
      ASSERT_TRUE(found.value && found.standard_error) << what << ": " << found.reason;
      const double error = *found.value - truth(*test.truth);
      const double z = error / *found.standard_error;
      sum += z;
      squares += z * z;
      square_error_sum += error * error;
    }
    const double n = kRepeats;
    const double mean = sum / n;
    const double variance = (squares - n * mean * mean) / (n - 1.0);
    std::printf("%-18s true %-9.6g rms error %-8.2g over %d tests; z mean %5.2f variance %.2f\n", what,
                truth(*tests().front().truth), std::sqrt(square_error_sum / n), kRepeats, mean, variance);
    EXPECT_NEAR(mean, 0.0, test::farthest_mean(n) * std::sqrt(variance)) << what;
    EXPECT_LT(variance, 1.05 * test::highest_mean_square(n - 1.0)) << what;
    EXPECT_GT(variance, 0.95 * test::lowest_mean_square(n - 1.0)) << what;
  }
}

TEST_P(DemoScenes, EstimatesThatAreThereAreFinite) {
  for (const test::AnalysedTest& test : tests()) {
    analysis::for_each_result(test.results, [](const analysis::ResultName& name, const Estimate& estimate) {
      EXPECT_EQ(estimate.value.has_value(), estimate.reason.empty()) << name.name;
      EXPECT_TRUE(!estimate.value || std::isfinite(*estimate.value)) << name.name;
    });
  }
}

INSTANTIATE_TEST_SUITE_P(
    Shipped, DemoScenes,
    testing::Values(DemoScene{"stick-slip-at-12-in-per-min", Regime::kStickSlip, Event::kNoRelativeMotion},
                    DemoScene{"ring-down-at-12-in-per-min", Regime::kRingDown, Event::kUnloaded}),
    [](const testing::TestParamInfo<DemoScene>& scene) {
      return scene.param.regime == Regime::kStickSlip ? "StickSlip" : "RingDown";
    });

}  // namespace
}  // namespace stickslip
