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
  constexpr std::uint64_t kSeed = 7;
  constexpr std::uint64_t kTests = 60;
  const auto bases = scenes_with_one_pull(std::filesystem::path{STICKSLIP_SOURCE_DIR} / "config/scenes");
  ASSERT_TRUE(bases) << bases.error().message;
  sweep::SweepPlan plan;
  for (std::uint64_t i = 0; i < kTests; ++i) {
    plan.seeds.push_back(sim::stream_seed(kSeed, i));
    plan.points.push_back(random_scene(*bases, plan.seeds.back()));
  }
  std::vector<std::int64_t> numbers(plan.points.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  const std::atomic<bool> stop{false};
  const auto take = [&](const record::SweepRun& run) -> base::Result<void> {
    const sim::Scene& scene = plan.points[static_cast<std::size_t>(run.number)];
    for (const auto& text : contradictions(run.results, sim::steady_pull_speed_m_per_s(scene)))
      ADD_FAILURE() << "seed " << kSeed << ", test " << run.number << " of " << scene.name << ", "
                    << model::name(run.results.regime) << " (" << run.results.regime_reason << "): " << text;
    return {};
  };
  const auto done = sweep::do_runs(plan, numbers, 2, stop, take);
  ASSERT_TRUE(done) << done.error().message;
}

}  // namespace
}  // namespace stickslip::test
