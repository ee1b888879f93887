// Scenes that the model does not describe: friction that falls with speed, a converter that cuts the peaks
// off. No test is blank, and none is confident and wrong.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "core/analysis/ladder.hpp"
#include "tests/support/sample_limits.hpp"
#include "tests/support/scene_tests.hpp"

namespace stickslip {
namespace {

using analysis::Estimate;
using model::Regime;

class Misfit : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Scenes, Misfit, testing::Values("velocity-weakening", "coarse-converter"),
                         [](const auto& scene) {
                           std::string name{scene.param};
                           std::erase(name, '-');
                           return name;
                         });

// Each slip is captured. A free end contradicts itself where the damping found is so small that the sled
// would have to stick again. What is left is a slip whose own S − K is so small that it may go on: one or two
// tests of 100 with friction that falls with speed. The intervals of fit and turning points cover the truth
// alike.
TEST_P(Misfit, EachTestHasNumbersThatCoverTheTruth) {
  constexpr int kTests = 60;
  const auto file =
      std::filesystem::path(STICKSLIP_SOURCE_DIR) / "config/scenes" / (std::string{GetParam()} + ".toml");
  const auto tests = test::analyse_scene(file, kTests);
  ASSERT_EQ(tests.size(), static_cast<std::size_t>(kTests));
  int by_turning_points = 0;
  int covered = 0;
  int mixed = 0;
  for (const test::AnalysedTest& test : tests) {
    const analysis::TestResults& results = test.results;
    EXPECT_NE(results.regime, Regime::kRingDown) << results.regime_reason;
    mixed += results.regime == Regime::kMixed ? 1 : 0;
    ASSERT_TRUE(results.mu_s.value && results.mu_k.value && results.delta_mu.value)
        << results.delta_mu.reason;
    constexpr double kSigmas = 2.0;
    const double error =
        results.delta_mu.systematic_uncertainty.value_or(0.0) + kSigmas * *results.delta_mu.standard_error;
    covered += std::abs(*results.delta_mu.value - (test.truth->mu_s - test.truth->mu_k)) <= error ? 1 : 0;
    if (results.omega.value) continue;  // By the fit.
    ++by_turning_points;
    ASSERT_FALSE(results.findings.empty());
    EXPECT_NE(results.findings.front().text.find("by turning points"), std::string::npos);
  }
  EXPECT_GT(by_turning_points, kTests / 4);
  EXPECT_GE(covered, test::lowest_count(kTests, 0.93));
  EXPECT_LE(mixed, test::highest_count(kTests, 0.02));
}

class OtherLaws : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Scenes, OtherLaws,
                         testing::Values("contact-ageing", "stribeck", "velocity-weakening",
                                         "rate-and-state-ageing", "rate-and-state-slip-law",
                                         "rate-and-state-above-critical"),
                         [](const auto& scene) {
                           std::string name{scene.param};
                           std::erase(name, '-');
                           return name;
                         });

// S of contacts that have rested as long as those of the test, K at the speed of the pull. Of 300 tests of
// each scene 93 % or more are within two errors (docs/detector-limits.md); of ten, more than three are not
// with a probability of 0.4 %.
TEST_P(OtherLaws, SAndKAreWithinTwoErrors) {
  constexpr int kTests = 10;
  constexpr int kMisses = 3;
  const auto file =
      std::filesystem::path(STICKSLIP_SOURCE_DIR) / "config/scenes" / (std::string{GetParam()} + ".toml");
  int misses_S = 0;
  int misses_K = 0;
  int misses_delta = 0;
  const auto misses = [](const Estimate& estimate, double truth) {
    return !estimate.value || std::abs(*estimate.value - truth) > 2.0 * analysis::total_error(estimate) ? 1
                                                                                                        : 0;
  };
  for (const test::AnalysedTest& test : test::analyse_scene(file, kTests)) {
    misses_S += misses(test.results.mu_s, test.truth->mu_s);
    misses_K += misses(test.results.mu_k, test.truth->mu_k);
    misses_delta += misses(test.results.delta_mu, test.truth->mu_s - test.truth->mu_k);
  }
  EXPECT_LE(misses_S, kMisses);
  EXPECT_LE(misses_K, kMisses);
  EXPECT_LE(misses_delta, kMisses);
}

// Hum is no noise and no friction: the fit of these tests leaves 1.3 to 1.5 times the noise.
TEST(MisfitOfTheFit, IsToldAndWidensTheIntervals) {
  constexpr int kTests = 20;
  const auto scene = [](const char* name) {
    return std::filesystem::path(STICKSLIP_SOURCE_DIR) / "config/scenes" / (std::string{name} + ".toml");
  };
  const auto tells = [](const analysis::TestResults& results) {
    return std::ranges::any_of(results.findings, [](const base::Finding& finding) {
      return finding.text.find("times the scan noise") != std::string::npos;
    });
  };
  for (const test::AnalysedTest& test : test::analyse_scene(scene("drift-hum-and-spikes"), kTests)) {
    EXPECT_TRUE(tells(test.results));
    // K has no other systematic part.
    EXPECT_GT(test.results.mu_k.systematic_uncertainty.value_or(0.0), 0.0);
  }
  int widened = 0;
  for (const test::AnalysedTest& test : test::analyse_scene(scene("stick-slip-at-12-in-per-min"), kTests)) {
    EXPECT_FALSE(tells(test.results));  // Above four standard errors in 3 of 10⁵ tests: none of 20.
    widened += test.results.mu_k.systematic_uncertainty ? 1 : 0;
  }
  EXPECT_LE(widened, 3);  // At a level of 1 % more are seen once in 20 000 sets.
}

}  // namespace
}  // namespace stickslip
