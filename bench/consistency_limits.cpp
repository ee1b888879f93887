// How often the results of a test contradict each other, or are far from the truth without a word: random
// tests over all shipped friction laws and effects, one line for each scene.
//
//     consistency_limits [TESTS [SEED]]      # 100000 tests, seed 1

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include "cli/sweep/runner.hpp"

#include "bench/arguments.hpp"
#include "tests/support/contradictions.hpp"
#include "tests/support/random_effects.hpp"

namespace {

using namespace stickslip;

struct Tally {
  std::uint64_t tests = 0;
  std::uint64_t with_value = 0;  ///< Of S − K.
  std::uint64_t contradictions = 0;
  std::uint64_t off = 0;     ///< S − K off by more than its errors allow.
  std::uint64_t silent = 0;  ///< Of those, without a finding.
};

}  // namespace

int main(int argc, char** argv) {
  const auto count = test::argument<std::uint64_t>(argc, argv, 1, 100'000);
  const auto seed = test::argument<std::uint64_t>(argc, argv, 2, 1);
  const auto bases =
      test::scenes_with_one_pull(std::filesystem::path{STICKSLIP_SOURCE_DIR} / "config/scenes");
  if (!bases) {
    fmt::print(stderr, "{}\n", bases.error().message);
    return 1;
  }
  sweep::SweepPlan plan;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t own = sim::stream_seed(seed, i);
    plan.points.push_back(test::random_scene(*bases, own));
    plan.seeds.push_back(own);
  }
  std::vector<std::int64_t> numbers(plan.points.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  std::map<std::string, Tally> tallies;
  const std::atomic<bool> stop{false};
  const auto take = [&](const record::SweepRun& run) -> base::Result<void> {
    const sim::Scene& scene = plan.points[static_cast<std::size_t>(run.number)];
    Tally& tally = tallies[scene.name];
    ++tally.tests;
    const auto found = test::contradictions(run.results, sim::steady_pull_speed_m_per_s(scene));
    tally.contradictions += found.empty() ? 0 : 1;
    for (const std::string& text : found)
      fmt::print("test {} of {}, {}: {}\n", run.number, scene.name, model::name(run.results.regime), text);
    const analysis::Estimate& delta_mu = run.results.delta_mu;
    if (!delta_mu.value) return {};
    ++tally.with_value;
    const double error = test::kContradictionSigmas * delta_mu.standard_error.value_or(0.0) +
                         delta_mu.systematic_uncertainty.value_or(0.0);
    if (std::abs(*delta_mu.value - (run.truth.mu_s - run.truth.mu_k)) <= error) return {};
    ++tally.off;
    tally.silent += run.results.findings.empty() ? 1 : 0;
    return {};
  };
  const auto threads = static_cast<std::int64_t>(std::max(std::thread::hardware_concurrency(), 1U));
  if (auto done = sweep::do_runs(plan, numbers, threads, stop, take); !done) {
    fmt::print(stderr, "{}\n", done.error().message);
    return 1;
  }
  fmt::print("{} random tests, seed {}\n{:<32} {:>7} {:>9} {:>14} {:>10} {:>9}\n", count, seed, "scene",
             "tests", "with S-K", "contradictions", "S - K off", "silently");
  Tally all;
  const auto print = [](const std::string& name, const Tally& tally) {
    fmt::print("{:<32} {:>7} {:>9} {:>14} {:>10} {:>9}\n", name, tally.tests, tally.with_value,
               tally.contradictions, tally.off, tally.silent);
  };
  for (const auto& [name, tally] : tallies) {
    print(name, tally);
    all = {all.tests + tally.tests, all.with_value + tally.with_value,
           all.contradictions + tally.contradictions, all.off + tally.off, all.silent + tally.silent};
  }
  print("all", all);
  return 0;
}
