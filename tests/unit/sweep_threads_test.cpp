#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <numeric>
#include <set>

#include "cli/simulation/simulate.hpp"
#include "cli/sweep/part_file.hpp"
#include "cli/sweep/run.hpp"
#include "cli/sweep/runner.hpp"

#include "core/base/clock.hpp"
#include "core/record/json_codec.hpp"
#include "core/record/sweep_file.hpp"
#include "core/sim/scene_truth.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/sweep_samples.hpp"

namespace stickslip::sweep {
namespace {

using record::SweepRun;

std::vector<std::int64_t> all_numbers(const SweepPlan& plan) {
  std::vector<std::int64_t> numbers(static_cast<std::size_t>(plan.run_count()));
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

/// Each run as text, by its number.
std::map<std::int64_t, std::string> runs_on(const SweepPlan& plan, std::int64_t threads) {
  std::map<std::int64_t, std::string> runs;
  const std::atomic<bool> stop{false};
  const auto done = do_runs(plan, all_numbers(plan), threads, stop, [&](const SweepRun& run) {
    EXPECT_TRUE(runs.emplace(run.number, record::sweep_run_to_json(run)).second) << run.number << " twice";
    return base::Result<void>{};
  });
  EXPECT_TRUE(done) << done.error().message;
  return runs;
}

TEST(SweepRunner, AnyNumberOfThreadsGivesTheSameBits) {
  const SweepPlan plan = test::small_plan();
  const auto runs = runs_on(plan, 1);
  ASSERT_EQ(runs.size(), 6U);
  for (const std::int64_t threads : {2, 4, 16}) EXPECT_EQ(runs_on(plan, threads), runs) << threads;
  // The comparison can fail: no two runs are alike, even without their numbers.
  std::set<std::string> results;
  for (const auto& [number, text] : runs) results.insert(text.substr(0, text.find("\"run\"")));
  EXPECT_EQ(results.size(), runs.size());
}

TEST(SweepRunner, ARunIsWhatSimulateGives) {
  const SweepPlan plan = test::small_plan();
  const test::ManualClock clock;
  for (const std::int64_t number : all_numbers(plan)) {
    const sim::Scene& scene = plan.points[static_cast<std::size_t>(number / plan.repeat)];
    const std::uint64_t seed = plan.seed_of(number);
    const auto simulation = simulation::simulate(scene, seed, clock);
    ASSERT_TRUE(simulation) << simulation.error().message;
    const SweepRun run = sweep_run(scene, seed, number);
    EXPECT_EQ(run.results, simulation->record.end->results);
    EXPECT_GT(run.results.gap_count.value.value_or(0.0), 0.0);
    const model::TestTruth& truth = *simulation->record.end->truth;
    EXPECT_EQ(run.truth.seed, seed);
    EXPECT_EQ(run.truth.regime, truth.regime);
    EXPECT_EQ(run.truth.mu_s, truth.mu_s);
    EXPECT_EQ(run.truth.amplitude, truth.amplitude);
    EXPECT_EQ(run.truth.static_coefficient, truth.static_coefficient);
    EXPECT_EQ(run.truth.oscillation_frequency_Hz, truth.oscillation_frequency_Hz);
    EXPECT_GT(run.true_cycle_count, 0);
  }
}

// Both count the slips from the first scan that arrived to the end of the scene.
TEST(SweepRunner, CountsTheTrueSlipsThatSimulateGives) {
  sim::Scene scene = test::small_plan().points[1];
  scene.duration_s = 2.0;
  scene.missing_scans->rate_per_s = 20.0;
  scene.missing_scans->mean_length_scans = 500.0;
  int late = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const auto simulation = simulation::simulate(scene, seed, test::ManualClock{});
    if (!simulation) continue;  // All scans are missing.
    const std::size_t count = simulation->record.end->truth->cycles.size();
    EXPECT_EQ(sweep_run(scene, seed, 0).true_cycle_count, static_cast<std::int64_t>(count)) << seed;
    late += sim::scene_truth(scene, scene.scan_rate_Hz, seed).cycles.size() > count ? 1 : 0;
  }
  EXPECT_GT(late, 0);
}

TEST(SweepRunner, StoppedAndResumedOnOtherThreadsGivesTheSameFile) {
  const test::TemporaryFolder folder;
  const test::ManualClock clock;
  const SweepPlan plan = test::small_plan();
  const record::SweepFacts facts = test::small_facts();
  const auto file_with = [&](const std::string& name, const std::vector<std::int64_t>& threads_of_calls,
                             std::int64_t stop_after) {
    const auto output = folder.path() / name;
    for (const std::int64_t threads : threads_of_calls) {
      auto part = PartFile::open(output.string() + ".part", facts, clock);
      EXPECT_TRUE(part) << part.error().message;
      std::atomic<bool> stop{false};
      std::int64_t taken = 0;
      const auto done = do_runs(plan, part->missing(), threads, stop, [&](const SweepRun& run) {
        if (++taken == stop_after) stop = true;
        return part->append(run);
      });
      EXPECT_TRUE(done) << done.error().message;
      if (part->done_count() < facts.run_count()) continue;
      EXPECT_TRUE(record::publish_sweep(facts, *part->table(), output));
      break;
    }
    return test::content_of(output);
  };
  const std::string whole = file_with("whole.h5", {1}, -1);
  EXPECT_GT(whole.size(), 10'000U);
  EXPECT_EQ(file_with("two.h5", {2}, -1), whole);
  // Each call finishes at least the run after which it is asked to stop: six are enough for all.
  EXPECT_EQ(file_with("resumed.h5", {1, 2, 4, 1, 1, 1}, 1), whole);
}

TEST(SweepRunner, StopsSoonAndLosesNothingThatWasBegun) {
  const SweepPlan plan = test::small_plan();
  std::atomic<bool> stop{true};
  const auto none = [](const SweepRun&) -> base::Result<void> { return base::failure("nothing may come"); };
  EXPECT_TRUE(do_runs(plan, all_numbers(plan), 2, stop, none));
  stop = false;
  EXPECT_TRUE(do_runs(plan, {}, 2, stop, none));
}

TEST(SweepRunner, AnErrorOfTheTakerEndsTheSweep) {
  const SweepPlan plan = test::small_plan();
  const std::atomic<bool> stop{false};
  int taken = 0;
  const auto done = do_runs(plan, all_numbers(plan), 2, stop, [&](const SweepRun&) -> base::Result<void> {
    ++taken;
    return base::failure("disk full");
  });
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().message, "disk full");
  EXPECT_EQ(taken, 1);
}

}  // namespace
}  // namespace stickslip::sweep
