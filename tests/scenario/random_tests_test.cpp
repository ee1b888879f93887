// The detector's word for a test against what the simulation really did, for tests of random papers and
// speeds with noise, drift and twenty spikes a second. bench/regime_limits prints the table for more.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/sim/scene.hpp"
#include "tests/support/escape_trials.hpp"
#include "tests/support/regime_tally.hpp"

namespace stickslip {
namespace {

constexpr int kTests = 300;
constexpr std::uint64_t kSeed = 7;

base::Result<sim::Scene> base_scene() {
  return sim::load_scene(std::filesystem::path{STICKSLIP_SOURCE_DIR} /
                         "config/scenes/ring-down-at-12-in-per-min.toml");
}

/// Mean and four standard deviations of a binomial count.
double highest_count(double of, double share) {
  return of * share + 4.0 * std::sqrt(of * share * (1.0 - share));
}

TEST(RandomTests, AreCalledWhatTheyAre) {
  const auto base = base_scene();
  ASSERT_TRUE(base) << base.error().message;
  const auto table = test::judge_random_tests(*base, {}, kTests, kSeed);
  ASSERT_TRUE(table) << table.error().message;
  test::RegimeTally all;
  for (const auto& [regime, tally] : table->of_regime) {
    EXPECT_NE(regime, friction::Regime::kUndecided) << "the truth knows";
    all.tests += tally.tests;
    all.wrong += tally.wrong;
    all.undecided += tally.undecided;
  }
  EXPECT_EQ(all.tests, kTests);
  // Of 10 000 tests 0.04 % are called wrongly and 0.36 % not at all (docs/detector.md), and a quarter more.
  EXPECT_LE(all.wrong, highest_count(kTests, 0.0005));
  EXPECT_LE(all.undecided, highest_count(kTests, 0.0045));
}

TEST(RandomTests, EscapesAreDeclaredSoonAndCapturesAreNotTakenForThem) {
  const auto base = base_scene();
  ASSERT_TRUE(base) << base.error().message;
  int captured = 0;
  int false_escapes = 0;
  int escapes = 0;
  int not_soon = 0;
  int not_in_three = 0;
  for (const test::EscapeTrial& trial : test::escape_trials(*base, {}, kTests, kSeed)) {
    captured += trial.captured;
    false_escapes += trial.false_escapes;
    if (!trial.escapes) continue;
    ++escapes;
    if (!(trial.periods <= 1.5)) ++not_soon;
    if (!(trial.periods <= 3.0)) ++not_in_three;
  }
  EXPECT_GT(captured, 1000);
  EXPECT_GT(escapes, 100);
  // Of 302 222 captured slips 26 were taken for escapes; of 12 409 escapes 12.2 % took longer than 1.5
  // periods, where 10.1 % could not be told sooner, and 0.06 % longer than 3 (docs/detector.md).
  EXPECT_LE(false_escapes, highest_count(captured, 8.6e-5));
  EXPECT_LE(not_soon, highest_count(escapes, 0.122));
  EXPECT_LE(not_in_three, highest_count(escapes, 0.0006));
}

}  // namespace
}  // namespace stickslip
