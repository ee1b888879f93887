// How much more reproducible S − K from all cycles is than the first peak less the mean (docs/promise.md):
// one line of a table for each cell.
//
//     promise_limits [TESTS [SEED [CYCLES [RATIO]]]]      # 1000 tests a cell, seed 1
//
// CYCLES, RATIO: only the rows of so many cycles, of this Q/Q_th.

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>

#include "bench/arguments.hpp"
#include "core/sim/scene.hpp"
#include "tests/support/promise.hpp"

namespace {

using namespace stickslip;

void print(const sim::Scene& base, const test::PromiseCell& cell, const test::PromiseResult& result) {
  const auto bias = [](const test::PromiseSample& sample) {
    return 100.0 * (sample.mean() / test::PromiseCell::kDeltaMu - 1.0);
  };
  const double expected = test::expected_traditional_error(cell, test::promise_Q(base, cell)) /
                          test::expected_delta_mu_error(cell);
  const auto share = [&](const test::PromisePair& pair) {
    if (pair.delta_mu.values.size() < 3) return std::string{"– | – | –"};
    return fmt::format("{:.1f}; {:+.1f} | {:.2f}; {:+.1f} | {:.2f} ± {:.2f}",
                       100.0 * pair.traditional.relative_error(), bias(pair.traditional),
                       100.0 * pair.delta_mu.relative_error(), bias(pair.delta_mu), pair.factor(),
                       pair.factor_standard_error());
  };
  fmt::print("| {} | {} | {:.0f} | {} | {:.1f} | {} | {} | {} | {:.1f} | {} |\n", cell.cycles,
             cell.speed_ratio, 100.0 * cell.scatter, cell.first_peak_sd, expected, share(result.stuck),
             result.stuck.tests(), share(result.all), result.cycle_count, result.all.delta_mu.missing);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t count = test::argument<std::uint64_t>(argc, argv, 1, 1000);
  const std::uint64_t seed = test::argument<std::uint64_t>(argc, argv, 2, 1);
  const int only_cycles = test::argument(argc, argv, 3, 0);
  const double only_ratio = test::argument(argc, argv, 4, 0.0);
  const auto base = sim::load_scene(std::filesystem::path{STICKSLIP_SOURCE_DIR} /
                                    "config/scenes/stick-slip-at-12-in-per-min.toml");
  if (!base) {
    fmt::print(stderr, "{}\n", base.error().message);
    return 1;
  }
  fmt::print("{} tests a cell, seed {}\n\n", count, seed);
  fmt::print(
      "| cycles | Q/Q_th | scatter, % | first-peak sd | expected | stuck again: first peak − mean: rel. "
      "s.e.; bias, "
      "% | S − K: rel. s.e.; bias, % | factor | tests | all: first peak − mean | S − K | factor | slips "
      "found | no "
      "S − K |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const int cycles : {10, 20, 190}) {
    if (only_cycles != 0 && only_cycles != cycles) continue;
    for (const double speed_ratio : {0.2, 0.3, 0.6}) {
      if (only_ratio > 0.0 && std::abs(only_ratio - speed_ratio) > 1e-6) continue;
      for (const double scatter : {0.1, 0.2, 0.3}) {
        for (const double first_peak_sd : {0.0, 0.01, 0.02, 0.04}) {
          const test::PromiseCell cell{.cycles = cycles,
                                       .scatter = scatter,
                                       .first_peak_sd = first_peak_sd,
                                       .speed_ratio = speed_ratio};
          const auto result = test::measure_promise(*base, cell, static_cast<std::int64_t>(count), seed);
          if (!result) {
            fmt::print(stderr, "{}\n", result.error().message);
            return 1;
          }
          print(*base, cell, *result);
        }
      }
    }
  }
  return 0;
}
