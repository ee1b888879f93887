// How often the detector's word for a test is right: random tests against the modes that the simulation
// really had, one table for each noise.
//
//     regime_limits [TESTS [SEED [ESTIMATOR]]]      # 10000 tests, seed 1, fit

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string_view>

#include "bench/arguments.hpp"
#include "core/model/regime.hpp"
#include "core/sim/scene.hpp"
#include "tests/support/regime_tally.hpp"

namespace {

using namespace stickslip;
void print(const test::RegimeTally& tally, std::string_view name) {
  const auto percent = [&](int count) { return tally.tests == 0 ? 0.0 : 100.0 * count / tally.tests; };
  fmt::print("{:<28} {:>7} {:>8.2f} % {:>10.2f} %\n", name, tally.tests, percent(tally.wrong),
             percent(tally.undecided));
}

}  // namespace

int main(int argc, char** argv) {
  const auto count = test::argument<std::uint64_t>(argc, argv, 1, 10'000);
  const auto seed = test::argument<std::uint64_t>(argc, argv, 2, 1);
  const auto estimator = argc > 3 ? detect::estimator_tier_from_name(argv[3]) : detect::EstimatorTier::kFit;
  if (!estimator) {
    fmt::print(stderr, "regime_limits: '{}' is neither turning-points nor fit\n", argv[3]);
    return 2;
  }
  const auto base = sim::load_scene(std::filesystem::path{STICKSLIP_SOURCE_DIR} /
                                    "config/scenes/ring-down-at-12-in-per-min.toml");
  if (!base) {
    fmt::print(stderr, "{}\n", base.error().message);
    return 1;
  }
  fmt::print("{} random tests of {} s, seed {}, estimator {}\n", count, base->constant_speed->pull_s, seed,
             detect::name(*estimator));
  fmt::print("S - K 0.02 to 0.1, its scatter 0 to 30 %, Q/Q_th 0.3 to 3\n");
  for (const double noise : {0.02, 0.05, 0.1}) {
    const test::Disturbance disturbance{.noise = noise};
    fmt::print("\nnoise {} (S - K), drift {} per s, {} spikes per s of {} (S - K)\n", noise,
               disturbance.drift_per_s, disturbance.spikes_per_s, disturbance.spike_size);
    const auto table =
        test::judge_random_tests(*base, disturbance, static_cast<std::int64_t>(count), seed, *estimator);
    if (!table) {
      fmt::print(stderr, "{}\n", table.error().message);
      return 1;
    }
    fmt::print("{:<28} {:>7} {:>10} {:>12}\n", "really", "tests", "wrong", "undecided");
    for (const auto& [regime, tally] : table->of_regime) print(tally, model::name(regime));
    print(table->few_captures, "with one to three captures");
    if (*estimator != detect::EstimatorTier::kFit) continue;  // The others give it no standard error.
    const test::TransitionTally& transitions = table->transitions;
    fmt::print(
        "transition_time of {} mixed tests: rms error {:.3f} ms, variance of error over standard error "
        "{:.3f}; "
        "another slip in {}\n",
        transitions.tests, 1e3 * transitions.rms_s(), transitions.variance(), transitions.other_slip);
  }
  return 0;
}
