#include "core/analysis/bootstrap.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>

#include "core/analysis/test_analysis.hpp"
#include "core/sim/scene_run.hpp"
#include "tests/support/sample_limits.hpp"
#include "tests/support/scatter_trials.hpp"

namespace stickslip::analysis {
namespace {

struct Drawn {
  TestResults results;
  Bootstrap bootstrap;

  [[nodiscard]] const BootstrapSpread& spread(std::string_view name) const {
    return *std::ranges::find(bootstrap.spreads, name, &BootstrapSpread::name);
  }
};

Drawn analysed(const sim::Scene& scene, std::uint64_t seed, const BootstrapSettings& settings,
               detect::EstimatorTier estimator = detect::EstimatorTier::kFit,
               const estimate::SharedPrior& prior = {}, base::ScanIndex frozen_scans = 0) {
  sim::SceneRun run{scene, scene.scan_rate_Hz};
  run.restart(seed);
  AnalysisSettings analysis_settings;
  analysis_settings.live = false;
  analysis_settings.estimator = estimator;
  analysis_settings.bootstrap = settings;
  analysis_settings.prior = prior;
  TestAnalysis analysis{analysis_settings};
  const auto pull_end =
      static_cast<base::ScanIndex>((0.5 + test::ScatterTrials::kPull_s) * scene.scan_rate_Hz);
  std::array<double, 64> raw{};
  base::ScanIndex index = 0;
  double value = 0.0;
  while (const std::size_t count = run.next(raw)) {
    for (std::size_t k = 0; k < count && index < pull_end; ++k, ++index) {
      constexpr base::ScanIndex kFreezes = 500;
      if (index < kFreezes || index >= kFreezes + frozen_scans) value = raw[k];
      analysis.add(index, value, false);
    }
  }
  Drawn drawn{analysis.finish(), {}};
  EXPECT_EQ(analysis.bootstrap().has_value(), settings.count > 0);
  drawn.bootstrap = analysis.bootstrap().value_or(Bootstrap{});
  return drawn;
}

sim::Scene scene(bool scattered) {
  sim::Scene scene = test::ScatterTrials::scene_at(8.0);
  if (!scattered) scene.paper.scatter.reset();
  return scene;
}

// The true error of a result is what its scatter over the drawings says, with one S and K for all and slip by
// slip.
TEST(Bootstrap, ScattersAsTheResultsAreOff) {
  constexpr int kTests = 24;
  for (const bool scattered : {false, true}) {
    SCOPED_TRACE(scattered ? "slips differ" : "slips alike");
    double square = 0.0;
    int tests = 0;
    for (int seed = 1; seed <= kTests; ++seed) {
      const Drawn drawn = analysed(scene(scattered), static_cast<std::uint64_t>(seed), {.count = 200});
      if (drawn.bootstrap.spreads.empty()) continue;  // Too few slips began from sticking.
      ++tests;
      const BootstrapSpread& delta_mu = drawn.spread("delta_mu");
      square += std::pow((*drawn.results.delta_mu.value - 0.05) / delta_mu.standard_deviation, 2);
      EXPECT_LT(delta_mu.lowest, *drawn.results.delta_mu.value);
      EXPECT_GT(delta_mu.highest, *drawn.results.delta_mu.value);
    }
    // Of some twenty slips a standard deviation is known to 16 %.
    ASSERT_GE(tests, kTests / 2);
    EXPECT_LT(square / tests, test::highest_mean_square(tests) * 1.2);
    EXPECT_GT(square / tests, test::lowest_mean_square(tests) / 1.2);
  }
}

TEST(Bootstrap, HasTheDriftInSAndKAsTheResults) {
  sim::Scene drifting = scene(false);
  drifting.kinetic_drift = sim::KineticDrift{.change = 0.01, .scale = 1.0};
  const Drawn drawn = analysed(drifting, 1, {.count = 200});
  ASSERT_EQ(drawn.bootstrap.reason, "");
  ASSERT_TRUE(drawn.results.drift_rate.value && *drawn.results.drift_rate.value > 0.001);
  for (const auto& [name, result] : {std::pair{"mu_s", drawn.results.mu_s}, {"mu_k", drawn.results.mu_k}}) {
    EXPECT_LT(drawn.spread(name).lowest, *result.value) << name;
    EXPECT_GT(drawn.spread(name).highest, *result.value) << name;
  }
}

// With a characterised tester the scatter of its damping is that of the characterisation.
TEST(Bootstrap, DrawsThePriorToo) {
  estimate::SharedPrior prior;
  const double omega = 2.0 * std::numbers::pi * 20.0;
  prior.coupling = {omega, 0.022, Eigen::Vector2d{1e-4, 1e-8}.asDiagonal()};
  const Drawn drawn = analysed(scene(true), 1, {.count = 400}, detect::EstimatorTier::kFit, prior);
  ASSERT_EQ(drawn.bootstrap.reason, "");
  EXPECT_NEAR(drawn.spread("gamma_over_2omega").standard_deviation, 1e-4, 2e-5);
}

TEST(Bootstrap, OfOneSeedIsTheSameEachTime) {
  const BootstrapSettings settings{.count = 100, .seed = 7};
  const Bootstrap one = analysed(scene(true), 1, settings).bootstrap;
  const Bootstrap again = analysed(scene(true), 1, settings).bootstrap;
  const Bootstrap other = analysed(scene(true), 1, {.count = 100, .seed = 8}).bootstrap;
  ASSERT_EQ(one.spreads.size(), 5U);
  for (std::size_t i = 0; i < one.spreads.size(); ++i) {
    EXPECT_EQ(one.spreads[i].standard_deviation, again.spreads[i].standard_deviation);
    EXPECT_NE(one.spreads[i].standard_deviation, other.spreads[i].standard_deviation);
  }
}

TEST(Bootstrap, LeavesTheResultsAsTheyAreAndSaysWhyThereIsNone) {
  const Drawn with = analysed(scene(true), 1, {.count = 100});
  const Drawn without = analysed(scene(true), 1, {});
  EXPECT_EQ(with.results.delta_mu.value, without.results.delta_mu.value);
  EXPECT_EQ(with.results.delta_mu.standard_error, without.results.delta_mu.standard_error);
  const Drawn by_turning_points =
      analysed(scene(true), 1, {.count = 100}, detect::EstimatorTier::kTurningPoints);
  EXPECT_TRUE(by_turning_points.bootstrap.spreads.empty());
  EXPECT_NE(by_turning_points.bootstrap.reason.find("turning points"), std::string::npos);
  // A value that stands still voids the results, and with them their scatter.
  const Drawn frozen = analysed(scene(true), 1, {.count = 100}, detect::EstimatorTier::kFit, {}, 60);
  EXPECT_FALSE(frozen.results.delta_mu.value);
  EXPECT_TRUE(frozen.bootstrap.spreads.empty());
  EXPECT_NE(frozen.bootstrap.reason.find("frozen"), std::string::npos) << frozen.bootstrap.reason;
}

}  // namespace
}  // namespace stickslip::analysis
