#include "core/analysis/test_analysis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "tests/support/allocation_count.hpp"
#include "tests/support/live_trials.hpp"

namespace stickslip::detect {
namespace {

TEST(TestAnalysis, AddsAScanWithoutAllocatingUntilABlockIsFull) {
  std::mt19937_64 engine{4};
  std::normal_distribution<double> normal{0.3, 0.001};
  analysis::TestAnalysis analysis{analysis::AnalysisSettings{}};
  analysis.add(0, 0.3, false);  // takes the first block of each column
  const std::uint64_t before = test::allocation_count();
  constexpr auto kBlock = static_cast<base::ScanIndex>(base::LongColumn<double>::kBlock);
  for (base::ScanIndex scan = 1; scan < kBlock; ++scan) analysis.add(scan, normal(engine), false);
  EXPECT_EQ(test::allocation_count(), before);
  analysis.add(kBlock, 0.3, false);
  EXPECT_GT(test::allocation_count(), before);  // else the test shows nothing
}

struct Analysed {
  analysis::TestResults results;
  std::vector<Cycle> cycles;
  std::vector<Cycle> live;
};

Analysed analysed(const test::LiveScene& scene, EstimatorTier tier) {
  analysis::AnalysisSettings settings;
  settings.estimator = tier;
  analysis::TestAnalysis analysis{settings};
  test::LiveTrial trial{scene};
  Analysed found;
  const auto take = [&] {
    for (const Cycle& cycle : analysis.take_new_cycles()) found.live.push_back(cycle);
  };
  for (base::ScanIndex scan = 0; scan < trial.scan_count(); ++scan) {
    analysis.add(scan, trial.next(), false);
    take();
  }
  found.results = analysis.finish();
  take();
  const base::LongColumn<Cycle>& cycles = analysis.cycles();
  found.cycles.assign(cycles.begin(), cycles.end());
  EXPECT_EQ(analysis.live().phase, Phase::kEnd);
  return found;
}

// What needs no model is the same with either estimator; what the fit alone knows is not told without it.
TEST(TurningPoints, TellsNothingThatItDoesNotKnow) {
  const test::LiveScene scene;
  const analysis::TestResults fit = analysed(scene, EstimatorTier::kFit).results;
  const analysis::TestResults other = analysed(scene, EstimatorTier::kTurningPoints).results;
  EXPECT_EQ(other.regime, model::Regime::kStickSlip);
  EXPECT_EQ(other.period_median, fit.period_median);
  EXPECT_EQ(other.static_coefficient, fit.static_coefficient);
  EXPECT_EQ(other.drift_rate, fit.drift_rate);
  EXPECT_EQ(other.cycle_count, fit.cycle_count);
  for (const analysis::Estimate* unknown :
       {&other.omega, &other.gamma_over_2omega, &other.Q, &other.threshold_speed, &other.delta_mu_combined,
        &other.pull_speed_measured}) {
    EXPECT_FALSE(unknown->value);
    EXPECT_NE(unknown->reason.find(name(EstimatorTier::kTurningPoints)), std::string::npos)
        << unknown->reason;
    EXPECT_NE(unknown->reason.find("\"fit\""), std::string::npos) << unknown->reason;
  }
  ASSERT_TRUE(other.delta_mu.value) << other.delta_mu.reason;
  EXPECT_NE(other.delta_mu, fit.delta_mu);
  EXPECT_NEAR(*other.mu_s.value - *other.mu_k.value, *other.delta_mu.value, 1e-12);
  EXPECT_NEAR(*other.delta_mu.value / (scene.S - scene.K), 1.0, 0.1);
}

// The rows of the record are those that were seen live, each slip's how it ended with them.
TEST(TurningPoints, KeepsTheCyclesAsTheyWereSeen) {
  const Analysed found = analysed(test::LiveScene{}, EstimatorTier::kTurningPoints);
  ASSERT_GT(found.cycles.size(), 5U);
  ASSERT_EQ(found.cycles.size(), found.live.size());
  for (std::size_t i = 0; i < found.cycles.size(); ++i) {
    const Cycle& row = found.cycles[i];
    const Cycle& live = found.live[i];
    EXPECT_EQ(row.number, static_cast<std::int64_t>(i));
    EXPECT_EQ(row.peak_time_s, live.peak_time_s);
    EXPECT_EQ(row.peak, live.peak);
    EXPECT_EQ((row.flags & kCycleIsFirst) != 0, i == 0);
    // In the last slip the pull ended: nobody knows how it would have.
    const bool last = i + 1 == found.cycles.size();
    if (!last && std::isfinite(live.live_capture_evidence)) {
      EXPECT_EQ(row.capture_evidence, live.live_capture_evidence);
    }
    EXPECT_EQ(row.flags & kCycleCaptured, last ? 0 : live.flags & kCycleCaptured);
    if (std::isfinite(live.delta_mu)) {
      EXPECT_EQ(row.delta_mu, live.delta_mu);
    }
    EXPECT_TRUE(std::isnan(row.delta_mu_standard_error));
  }
  const std::ptrdiff_t captured = std::ranges::count_if(
      found.live, [](const Cycle& cycle) { return (cycle.flags & kCycleCaptured) != 0; });
  const bool last = (found.live.back().flags & kCycleCaptured) != 0;
  EXPECT_EQ(*found.results.stick_cycle_count.value, static_cast<double>(captured - (last ? 1 : 0)));
}

// The last slip has no next one, and so no period by which to find what was seen of it.
TEST(TestAnalysis, EachRowHasWhatWasSeenOfItsOwnSlip) {
  const Analysed found = analysed(test::LiveScene{}, EstimatorTier::kFit);
  ASSERT_EQ(found.cycles.size(), found.live.size());
  for (std::size_t i = 0; i < found.cycles.size(); ++i) {
    EXPECT_NEAR(found.cycles[i].peak_time_s, found.live[i].peak_time_s, 0.01);
    const double row = found.cycles[i].live_capture_evidence;
    const double live = found.live[i].live_capture_evidence;
    EXPECT_TRUE(row == live || (std::isnan(row) && std::isnan(live))) << i << ": " << row << ", " << live;
  }
}

// A test that escapes: its slips say so while it runs, and with them the whole.
TEST(TurningPoints, SeesAnEscape) {
  test::LiveScene scene;
  scene.escape_Q = 3.0;
  const Analysed found = analysed(scene, EstimatorTier::kTurningPoints);
  EXPECT_EQ(found.results.regime, model::Regime::kMixed) << found.results.regime_reason;
  ASSERT_TRUE(found.results.transition_time.value) << found.results.transition_time.reason;
  EXPECT_FALSE(found.results.transition_time.standard_error);
}

}  // namespace
}  // namespace stickslip::detect
