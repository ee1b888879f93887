// How soon the live detector declares an escape in random tests, with the tester characterised, and how often
// it takes a captured slip for one: the table of docs/detector-limits.md.
//
//     escape_limits [TESTS [SEED [FILE [SPIKES_PER_S]]]]      # 10000 tests, seed 1, 20 spikes a second
//
// FILE gets Q/Q_th and the noise over S - K of each escape, for the bound (escape_bound.py).

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "bench/arguments.hpp"
#include "core/sim/scene.hpp"
#include "tests/support/escape_trials.hpp"

namespace {

using namespace stickslip;

struct Band {
  double from = 0.0;  ///< Of Q/Q_th.
  double to = 0.0;
};

void print_row(const std::string& what, const std::vector<test::EscapeTrial>& trials, Band band, bool later) {
  int count = 0;
  int soon = 0;
  int in_three = 0;
  for (const test::EscapeTrial& trial : trials) {
    if (!trial.escapes || trial.over_threshold < band.from || trial.over_threshold >= band.to) continue;
    if (later && trial.first) continue;
    ++count;
    soon += trial.periods <= 1.5 ? 1 : 0;
    in_three += trial.periods <= 3.0 ? 1 : 0;
  }
  if (count == 0) return;
  fmt::print("| {} | {} | {:.2f} | {:.2f} |\n", what, count, 100.0 * soon / count, 100.0 * in_three / count);
}

}  // namespace

int main(int argc, char** argv) {
  const auto count = test::argument<std::size_t>(argc, argv, 1, 10'000);
  const auto seed = test::argument<std::uint64_t>(argc, argv, 2, 1);
  const auto base = sim::load_scene(std::filesystem::path{STICKSLIP_SOURCE_DIR} /
                                    "config/scenes/ring-down-at-12-in-per-min.toml");
  if (!base) {
    fmt::print(stderr, "{}\n", base.error().message);
    return 1;
  }
  test::Disturbance disturbance;
  disturbance.spikes_per_s = test::argument(argc, argv, 4, disturbance.spikes_per_s);
  const std::vector<test::EscapeTrial> trials = test::escape_trials(*base, disturbance, count, seed);
  if (argc > 3) {
    std::ofstream list{argv[3]};
    for (const test::EscapeTrial& trial : trials) {
      if (trial.escapes) list << fmt::format("{},{}\n", trial.over_threshold, trial.noise);
    }
    if (!list.flush()) {
      fmt::print(stderr, "escape_limits: {} cannot be written\n", argv[3]);
      return 1;
    }
  }
  std::int64_t captured = 0;
  std::int64_t wrong = 0;
  for (const test::EscapeTrial& trial : trials) {
    captured += trial.captured;
    wrong += trial.false_escapes;
  }
  fmt::print("{} random tests, seed {}: {} captured slips, {} of them taken for an escape\n\n", count, seed,
             captured, wrong);
  fmt::print("| Q/Q_th of the escape | escapes | within 1.5 periods, % | within 3, % |\n|---|---|---|---|\n");
  for (const Band band : {Band{1.0, 1.05}, {1.05, 1.13}, {1.13, 1.35}, {1.35, 2.0}, {2.0, 1e300}}) {
    print_row(band.to < 1e300 ? fmt::format("{:.2f} to {:.2f}", band.from, band.to)
                              : fmt::format("above {:.2f}", band.from),
              trials, band, false);
  }
  print_row("all", trials, {0.0, 1e300}, false);
  print_row("all, after captured slips", trials, {0.0, 1e300}, true);
  return 0;
}
