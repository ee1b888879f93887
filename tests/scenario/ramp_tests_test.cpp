// Ramp tests [Penner 1995, future work]: S − K slip by slip is right at any acceleration and scatter; the
// speed at which the sled escapes is low by a known amount, and right once that is taken off.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/support/ramp_trials.hpp"
#include "tests/support/sample_limits.hpp"
#include "tests/support/sanitized.hpp"

namespace stickslip {
namespace {

void print(const test::RampTrials& trials) {
  std::printf(
      "%.1f mm/s2, scatter %.0f %%, %d ramps of %.0f slips: S - K %+.3f %% pooled, rms %.2f CV/sqrt(N), z "
      "%.2f; "
      "escape at %.3f (sd %.3f) v_th, corrected %+.2f +- %.2f %% (sd %.1f %%, z %.2f)\n",
      1e3 * trials.acceleration_m_per_s2, 100.0 * trials.cv, trials.tests, trials.slips.mean,
      100.0 * trials.pooled_bias(), trials.cv > 0.0 ? trials.rms_over_sampling() : 0.0,
      trials.delta_mu_z.sd(), trials.escape.mean, trials.escape.sd(), 100.0 * (trials.corrected.mean - 1.0),
      100.0 * trials.corrected.standard_error(), 100.0 * trials.corrected.sd(), trials.corrected_z.sd());
}

/// 0.5 %, and what a scatter of CV allows the mean of all slips.
double allowed_bias(const test::RampTrials& trials) {
  return 0.005 + test::farthest_mean(static_cast<double>(trials.pooled_count)) * trials.cv;
}

struct Ramp {
  double acceleration_m_per_s2;
  double cv;
  double known_escape;  ///< Part of the threshold speed at which the sled escapes on average
                        ///< [docs/detector-limits.md].
  int seeds;
};

class RampTests : public testing::TestWithParam<Ramp> {};

TEST_P(RampTests, EachSlipMeasuresDeltaMuAndTheEscapeIsCorrected) {
  const Ramp& ramp = GetParam();
  test::RampTrials trials{ramp.acceleration_m_per_s2, ramp.cv};
  trials.run(1, test::kSanitized ? 2 : ramp.seeds);
  print(trials);
  EXPECT_EQ(trials.without_delta_mu, 0);
  EXPECT_EQ(trials.without_escape, 0);
  EXPECT_NEAR(trials.pooled_bias(), 0.0, allowed_bias(trials));
  if (test::kSanitized) return;
  const double n = trials.tests;
  if (ramp.cv > 0.0) {
    EXPECT_LT(trials.rms_over_sampling(), 1.2 * std::sqrt(test::highest_mean_square(n)));
  } else {
    // The escaping slip is at most a cycle of 60 ms late.
    EXPECT_LT(trials.escape.mean,
              1.0 + 0.06 * ramp.acceleration_m_per_s2 / test::RampTrials::threshold_m_per_s());
  }
  EXPECT_NEAR(trials.escape.mean, ramp.known_escape, 0.03 + 3.0 * trials.escape.standard_error());
  EXPECT_NEAR(trials.corrected.mean, 1.0, 0.03 + 3.0 * trials.corrected.standard_error());
}

INSTANTIATE_TEST_SUITE_P(Limits, RampTests,
                         testing::Values(Ramp{0.1e-3, 0.1, 0.803, 2}, Ramp{0.5e-3, 0.0, 0.987, 2},
                                         Ramp{0.5e-3, 0.1, 0.839, 24}, Ramp{0.5e-3, 0.2, 0.683, 12},
                                         Ramp{2e-3, 0.0, 0.944, 3}, Ramp{2e-3, 0.2, 0.725, 24}),
                         [](const testing::TestParamInfo<Ramp>& ramp) {
                           return fmt::format("By{:.0f}MicrometresPerS2Scatter{:.0f}",
                                              1e6 * ramp.param.acceleration_m_per_s2, 100.0 * ramp.param.cv);
                         });

}  // namespace
}  // namespace stickslip
