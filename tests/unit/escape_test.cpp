#include "core/analysis/escape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <utility>
#include <vector>

#include "tests/support/sample_limits.hpp"

namespace stickslip::analysis {
namespace {

EscapeTrial trial(double speed_m_per_s, bool captured) { return {speed_m_per_s, speed_m_per_s, captured}; }

TEST(Escape, WithoutScatterItIsBetweenTheTwoSpeeds) {
  const std::vector<EscapeTrial> trials{trial(0.005, true), trial(0.0052, true), trial(0.0054, false)};
  const EscapeSpeeds speeds = escape_speeds(trials, 0.0);
  EXPECT_EQ(speeds.first_escape.value, 0.0054);
  ASSERT_TRUE(speeds.of_mean_paper.value) << speeds.of_mean_paper.reason;
  EXPECT_GT(*speeds.of_mean_paper.value, 0.0052);
  EXPECT_LT(*speeds.of_mean_paper.value, 0.0054);
  // No better than a place anywhere between the two, 0.2 mm/s/√12, nor worse than the whole.
  EXPECT_GT(*speeds.of_mean_paper.standard_error, 0.0002 / std::sqrt(12.0) * 0.8);
  EXPECT_LT(*speeds.of_mean_paper.standard_error, 0.0002);
}

TEST(Escape, OfSlipsThatDifferByRoundingAloneNoMeanIsTold) {
  for (const double gap : {0.0, 1e-15, 1e-13, 3e-13}) {
    const std::vector<EscapeTrial> trials{trial(0.005, true), trial(0.005 * (1.0 + gap), false)};
    const EscapeSpeeds speeds = escape_speeds(trials, 0.0);
    EXPECT_FALSE(speeds.of_mean_paper.value) << gap;
    EXPECT_EQ(speeds.of_mean_paper.reason, "slips at one speed ended in both ways without scatter");
  }
}

TEST(Escape, NeedsBothEnds) {
  const std::vector<EscapeTrial> all{trial(0.005, true), trial(0.0052, true)};
  EXPECT_NE(escape_speeds(all, 0.1).first_escape.reason.find("was not reached"), std::string::npos);
  const std::vector<EscapeTrial> none{trial(0.005, false)};
  EXPECT_NE(escape_speeds(none, 0.1).of_mean_paper.reason.find("lies below 0.005 m/s"), std::string::npos);
  EXPECT_FALSE(escape_speeds({}, 0.1).first_escape.value);
}

TEST(Escape, IsUnbiasedOverManyRampsAndItsErrorsTell) {
  // Ramps of `count` slips a threshold speed, log-normal with 10 %. Beyond the scatter of a mean, a few per
  // cent of sd are left, since the steps of a linear ramp are not those of a place: 0.5 %. The mean square of
  // errors over standard errors scatters by twice as much for these skew ones as for normal ones.
  constexpr double kScatter = 0.1;
  constexpr double kThreshold_m_per_s = 0.0075;
  std::mt19937_64 engine{1};
  const double sigma = std::sqrt(std::log1p(kScatter * kScatter));
  for (const auto& [count, kRamps] : std::vector<std::pair<int, int>>{{40, 300}, {150, 300}, {1000, 60}}) {
    std::lognormal_distribution<double> own{std::log(kThreshold_m_per_s) - 0.5 * sigma * sigma, sigma};
    double raw = 0.0;
    double mean = 0.0;
    double squares = 0.0;
    double z_squares = 0.0;
    for (int i = 0; i < kRamps; ++i) {
      std::vector<EscapeTrial> trials;
      do {
        const double speed = kThreshold_m_per_s * (0.3 + static_cast<double>(trials.size() + 1) / count);
        trials.push_back(trial(speed, own(engine) > speed));
      } while (trials.back().captured);
      const EscapeSpeeds speeds = escape_speeds(trials, kScatter);
      ASSERT_TRUE(speeds.of_mean_paper.value) << speeds.of_mean_paper.reason;
      const double error = *speeds.of_mean_paper.value / kThreshold_m_per_s - 1.0;
      raw += *speeds.first_escape.value / kThreshold_m_per_s / kRamps;
      mean += error / kRamps;
      squares += error * error / kRamps;
      z_squares += std::pow(error * kThreshold_m_per_s / *speeds.of_mean_paper.standard_error, 2) / kRamps;
    }
    std::printf("%4d slips: escape at %.3f v_th; corrected %+.2f %%, rms %.2f %%, z %.2f\n", count, raw,
                100.0 * mean, 100.0 * std::sqrt(squares), std::sqrt(z_squares));
    EXPECT_LT(raw, 0.95) << "then there is nothing to correct";
    EXPECT_NEAR(mean, 0.0, 0.005 + test::farthest_mean(kRamps) * std::sqrt(squares));
    EXPECT_LT(z_squares, 1.1 + 2.0 * (test::highest_mean_square(kRamps) - 1.0));
    EXPECT_GT(z_squares, 0.9 - 2.0 * (1.0 - test::lowest_mean_square(kRamps)));
  }
}

}  // namespace
}  // namespace stickslip::analysis
