// No pair of numbers of a test contradicts another, whatever the friction law and the instrument.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <vector>

#include "cli/sweep/runner.hpp"

#include "tests/support/contradictions.hpp"
#include "tests/support/random_effects.hpp"

namespace stickslip::test {
namespace {

TEST(Consistency, NoNumberOfATestContradictsAnother) {
  struct Case {
    std::uint64_t seed;
    std::uint64_t test;
  };
  // The last ones: two stuck, and their fits do not tell S from K; the damping of one is so uncertain that it
  // may stick, at a period below that of its oscillation; one scatters.
  std::vector<Case> cases;
  for (std::uint64_t test = 0; test < 60; ++test) cases.push_back({7, test});
  cases.insert(cases.end(), {{1, 2003}, {2, 1919}, {1, 14960}, {1, 11417}});
  const auto bases = scenes_with_one_pull(std::filesystem::path{STICKSLIP_SOURCE_DIR} / "config/scenes");
  ASSERT_TRUE(bases) << bases.error().message;
  sweep::SweepPlan plan;
  for (const auto& [seed, test] : cases) {
    plan.seeds.push_back(sim::stream_seed(seed, test));
    plan.points.push_back(random_scene(*bases, plan.seeds.back()));
  }
  std::vector<std::int64_t> numbers(plan.points.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  const std::atomic<bool> stop{false};
  const auto take = [&](const record::SweepRun& run) -> base::Result<void> {
    const auto number = static_cast<std::size_t>(run.number);
    const sim::Scene& scene = plan.points[number];
    for (const auto& text : contradictions(run.results, sim::steady_pull_speed_m_per_s(scene)))
      ADD_FAILURE() << "seed " << cases[number].seed << ", test " << cases[number].test << " of "
                    << scene.name << ", " << model::name(run.results.regime) << " ("
                    << run.results.regime_reason << "): " << text;
    return {};
  };
  const auto done = sweep::do_runs(plan, numbers, 2, stop, take);
  ASSERT_TRUE(done) << done.error().message;
}

}  // namespace
}  // namespace stickslip::test
