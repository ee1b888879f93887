// Kinetic friction with a slope μ′ on a tester that was characterised on paper without one. The slope leaves
// S, K and S − K at the pull speed as they are and adds g μ′ to the damping.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>

#include "tests/support/characterised.hpp"
#include "tests/support/record_samples.hpp"
#include "tests/support/sample_limits.hpp"
#include "tests/support/scene_tests.hpp"

namespace stickslip {
namespace {

class FrictionSlope : public testing::TestWithParam<double> {
 protected:
  /// Tests of 5 s of the shipped stick-slip with this slope, in s/m, each with the tester of one ring-down.
  std::vector<test::AnalysedTest> tests(double slope, std::uint64_t seed) {
    std::ifstream shipped{std::filesystem::path(STICKSLIP_SOURCE_DIR) /
                          "config/scenes/stick-slip-at-12-in-per-min.toml"};
    std::stringstream text;
    text << shipped.rdbuf()
         << fmt::format("\n[effects.velocity_dependence]\nper_speed = \"{} s/m\"\n", slope);
    std::string scene = text.str();
    const auto at = scene.find("\nseed = ") + 1;
    scene.replace(at, scene.find('\n', at) - at, fmt::format("seed = {}", seed));
    const std::filesystem::path file = folder_.path() / fmt::format("{}.toml", seed);
    std::ofstream{file} << scene;
    constexpr double kOmega = 2.0 * std::numbers::pi * 20.0;
    constexpr double kGammaOver2Omega = 0.022;
    return test::analyse_scene(file, kRepeats, {}, test::characterised(kOmega, kGammaOver2Omega, seed));
  }

  static constexpr int kRepeats = 2;
  static constexpr int kSeeds = 8;
  test::TemporaryFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(Slopes, FrictionSlope, testing::Values(0.0, -0.1, -0.2, 0.1), [](const auto& slope) {
  return fmt::format("{}{:02.0f}", slope.param < 0 ? "Falls" : "Rises", std::abs(slope.param) * 100.0);
});

TEST_P(FrictionSlope, IsFoundAndLeavesTheCoefficientsAtThePullSpeed) {
  constexpr double kSpeed_m_per_s = 12.0 * 0.0254 / 60.0;
  const double slope = GetParam();
  const double mu_k = 0.30 + slope * kSpeed_m_per_s;
  double squares = 0.0;
  double squares_of_delta_mu = 0.0;
  double count = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    for (const test::AnalysedTest& test : tests(slope, seed)) {
      const analysis::TestResults& results = test.results;
      ASSERT_TRUE(results.mu_slope.value) << results.mu_slope.reason;
      ASSERT_LT(results.mu_slope.standard_error.value(), 0.03);
      squares += std::pow((*results.mu_slope.value - slope) / *results.mu_slope.standard_error, 2);
      // The damper's convention is no part of the error here.
      const auto error = [](const analysis::Estimate& estimate) {
        return std::hypot(*estimate.standard_error, estimate.systematic_uncertainty.value_or(0.0));
      };
      squares_of_delta_mu += std::pow((*results.delta_mu.value - (0.35 - mu_k)) / error(results.delta_mu), 2);
      count += 1.0;
    }
  }
  EXPECT_LT(squares / count, test::highest_mean_square(count));
  EXPECT_GT(squares / count, test::lowest_mean_square(count));
  EXPECT_LT(squares_of_delta_mu / count, test::highest_mean_square(count));
}

}  // namespace
}  // namespace stickslip
