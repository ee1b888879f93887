// S − K, S and K from features of the cycles against what was simulated: no bias that their standard errors
// do not allow, and standard errors that are right.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

#include "core/analysis/test_analysis.hpp"
#include "tests/support/estimator_limits.hpp"
#include "tests/support/sample_limits.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/scatter_trials.hpp"

namespace stickslip::analysis {
namespace {

/// Errors of one result over many tests.
struct Tally {
  double z_sum = 0.0;
  double z_square_sum = 0.0;
  double relative_sum = 0.0;
  int count = 0;
  int missing = 0;

  void add(const Estimate& estimate, double truth) {
    if (!estimate.value || !estimate.standard_error) {
      ++missing;
      return;
    }
    const double z = (*estimate.value - truth) / *estimate.standard_error;
    z_sum += z;
    z_square_sum += z * z;
    relative_sum += *estimate.standard_error / truth;
    ++count;
  }
  [[nodiscard]] double mean() const { return z_sum / count; }
  [[nodiscard]] double variance() const { return z_square_sum / count - mean() * mean(); }
};

struct Tallies {
  Tally amplitude;
  Tally timing;
  Tally slip_speed;
  Tally combined;
  Tally K;
  Tally S;
  Tally speed;

  void add(const TestResults& results, double mu_s, double mu_k, double speed_m_per_s) {
    amplitude.add(results.delta_mu_from_amplitude, mu_s - mu_k);
    timing.add(results.delta_mu_from_timing, mu_s - mu_k);
    slip_speed.add(results.delta_mu_from_slip_speed, mu_s - mu_k);
    combined.add(results.delta_mu_combined, mu_s - mu_k);
    K.add(results.mu_k_from_mean, mu_k);
    S.add(results.mu_s_from_amplitude, mu_s);
    speed.add(results.pull_speed_measured, speed_m_per_s);
  }
  template <typename Check>
  void each(const Check& check) const {
    check("amplitude", amplitude);
    check("timing", timing);
    check("slip speed", slip_speed);
    check("combined", combined);
    check("K", K);
    check("S", S);
    check("speed", speed);
  }
};

/// Cycles behind a standard error: its square is a sample variance, so that errors over it follow Student's t
/// with variance (n − 1)/(n − 3) where the cycles alone make it, and less where ω, γ and r do.
void expect_right(const char* what, const Tally& tally, int tests, double cycles) {
  ASSERT_GT(tally.count, tests / 2) << what;
  const double n = tally.count;
  EXPECT_LE(std::abs(tally.mean()), test::farthest_mean(n) * std::sqrt(tally.variance())) << what;
  const double student = (cycles - 1.0) / (cycles - 3.0);
  EXPECT_LT(tally.variance(), student * test::highest_mean_square(n - 1.0)) << what;
  // Features and ω, γ, r come from the same scans: where their errors cancel, what is given is too much.
  EXPECT_GT(tally.variance(), 0.8 * test::lowest_mean_square(n - 1.0)) << what;
}

TEST(CycleFeatures, GiveTheTruthWithinTheirStandardErrors) {
  const int tests = test::kSanitized ? 15 : 60;
  for (const double in_per_min : {4.0, 12.0}) {
    const test::LimitScene scene{in_per_min};
    Tallies tallies;
    for (int seed = 1; seed <= tests; ++seed) {
      TestAnalysis analysis{AnalysisSettings{}};
      std::mt19937_64 engine{static_cast<std::uint64_t>(seed)};
      std::normal_distribution<double> normal{0.0, test::LimitScene::kSigma};
      base::ScanIndex index = 0;
      for (const double value : scene.exact()) analysis.add(index++, value + normal(engine), false);
      tallies.add(analysis.finish(), 0.35, 0.30, in_per_min * test::LimitScene::kInchPerMinute_m_per_s);
    }
    SCOPED_TRACE(in_per_min);
    // Of eleven slips the first does not count, and the last does not stick before the trace ends.
    tallies.each([&](const char* what, const Tally& tally) { expect_right(what, tally, tests, 9.0); });
  }
}

TEST(CycleFeatures, GiveTheMeanOfSlipsThatScatter) {
  // 30 % scatter at 4 in/min, some 24 cycles a test: what S − K is convex in must not shift its mean.
  const int tests = test::kSanitized ? 10 : 40;
  const test::ScatterTrials trials{4.0, tests};
  Tallies tallies;
  for (const TestResults& results : trials.results) {
    tallies.add(results, 0.35, 0.30, 4.0 * test::LimitScene::kInchPerMinute_m_per_s);
  }
  tallies.each([&](const char* what, const Tally& tally) { expect_right(what, tally, tests, 20.0); });
}

TEST(CycleFeatures, SayWhyThereAreNone) {
  const test::LimitScene scene;
  TestAnalysis short_one{AnalysisSettings{}};
  base::ScanIndex index = 0;
  // Half a second of rest, the loading, and four of some eleven slips.
  const auto four_slips = static_cast<std::size_t>(0.68 * static_cast<double>(scene.exact().size()));
  std::mt19937_64 engine{1};
  std::normal_distribution<double> normal{0.0, test::LimitScene::kSigma};
  for (std::size_t k = 0; k < four_slips; ++k) {
    short_one.add(index++, scene.exact()[k] + normal(engine), false);
  }
  const TestResults few = short_one.finish();
  for (const Estimate* estimate :
       {&few.delta_mu_from_amplitude, &few.delta_mu_from_timing, &few.delta_mu_from_slip_speed,
        &few.delta_mu_combined, &few.mu_k_from_mean, &few.mu_s_from_amplitude}) {
    EXPECT_FALSE(estimate->value);
    EXPECT_NE(estimate->reason.find("are needed"), std::string::npos) << estimate->reason;
  }
}

}  // namespace
}  // namespace stickslip::analysis
