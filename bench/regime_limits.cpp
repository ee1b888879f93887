// How often the detector's word for a test is right: random tests against the modes that the simulation
// really had, one table for each noise.
//
//     regime_limits [TESTS [SEED]]      # 10000 tests, seed 1

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "core/friction/regime.hpp"
#include "core/sim/scene.hpp"
#include "core/sim/scene_truth.hpp"
#include "daemon/sweep/runner.hpp"
#include "tests/support/random_tests.hpp"

namespace {

using namespace stickslip;
using friction::Regime;

struct Tally {
  int tests = 0;
  int wrong = 0;
  int undecided = 0;

  void add(Regime truth, Regime measured) noexcept {
    ++tests;
    if (measured == Regime::kUndecided) {
      ++undecided;
    } else if (measured != truth) {
      ++wrong;
    }
  }
  void print(std::string_view name) const {
    const auto percent = [this](int count) { return tests == 0 ? 0.0 : 100.0 * count / tests; };
    fmt::print("{:<28} {:>7} {:>8.2f} % {:>10.2f} %\n", name, tests, percent(wrong), percent(undecided));
  }
};

struct Table {
  std::array<Tally, friction::kRegimeNames.size()> of_regime;
  Tally few_captures;
};

Tally& of(Table& table, Regime regime) {
  for (std::size_t i = 0; i < friction::kRegimeNames.size(); ++i) {
    if (friction::kRegimeNames[i].first == regime) return table.of_regime[i];
  }
  std::abort();
}

/// \param misses  prints each test that was called wrongly, so that it can be made again.
Table judge(const sim::Scene& base, const test::Disturbance& disturbance, std::int64_t count,
            std::uint64_t seed, bool misses) {
  daemon::SweepPlan plan;
  for (std::int64_t i = 0; i < count; ++i) {
    const std::uint64_t own = sim::stream_seed(seed, static_cast<std::uint64_t>(i));
    plan.points.push_back(test::random_test(base, disturbance, own));
    plan.seeds.push_back(own);
  }
  std::vector<std::int64_t> numbers(static_cast<std::size_t>(count));
  std::iota(numbers.begin(), numbers.end(), 0);
  Table table;
  const std::atomic<bool> stop{false};
  const auto take = [&](const record::SweepRun& run) -> base::Result<void> {
    const sim::Scene& scene = plan.points[static_cast<std::size_t>(run.number)];
    const friction::TestTruth truth = sim::scene_truth(scene, scene.scan_rate_Hz, plan.seed_of(run.number));
    const int captured = test::captures(truth, *sim::pull_of(scene));
    of(table, truth.regime).add(truth.regime, run.results.regime);
    if (captured >= 1 && captured <= 3) table.few_captures.add(truth.regime, run.results.regime);
    if (misses && run.results.regime != truth.regime) {
      fmt::print("  test {}: {} called {} ({} captures; {})\n", run.number, name(truth.regime),
                 name(run.results.regime), captured, run.results.regime_reason);
    }
    return {};
  };
  const auto threads = static_cast<std::int64_t>(std::max(std::thread::hardware_concurrency(), 1U));
  if (const auto done = daemon::do_runs(plan, numbers, threads, stop, take); !done) {
    fmt::print(stderr, "{}\n", done.error().message);
    std::exit(1);
  }
  return table;
}

std::uint64_t number(const char* text) {
  std::uint64_t value = 0;
  const std::string_view whole{text};
  const auto [end, error] = std::from_chars(whole.data(), whole.data() + whole.size(), value);
  if (error == std::errc{} && end == whole.data() + whole.size() && value > 0) return value;
  fmt::print(stderr, "regime_limits: '{}' is no whole number above 0\n", whole);
  std::exit(2);
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t count = argc > 1 ? number(argv[1]) : 10'000;
  const std::uint64_t seed = argc > 2 ? number(argv[2]) : 1;
  const auto base = sim::load_scene(std::filesystem::path{STICKSLIP_SOURCE_DIR} /
                                    "config/scenes/ring-down-at-12-in-per-min.toml");
  if (!base) {
    fmt::print(stderr, "{}\n", base.error().message);
    return 1;
  }
  fmt::print("{} random tests of {} s, seed {}: S - K 0.02 to 0.1, its scatter 0 to 30 %, Q/Q_th 0.3 to 3\n",
             count, base->constant_speed->pull_s, seed);
  for (const double noise : {0.02, 0.05, 0.1}) {
    const test::Disturbance disturbance{.noise = noise};
    fmt::print("\nnoise {} (S - K), drift {} per s, {} spikes per s of {} (S - K)\n", noise,
               disturbance.drift_per_s, disturbance.spikes_per_s, disturbance.spike_size);
    Table table = judge(*base, disturbance, static_cast<std::int64_t>(count), seed, argc > 3);
    fmt::print("{:<28} {:>7} {:>10} {:>12}\n", "really", "tests", "wrong", "undecided");
    for (std::size_t i = 0; i < table.of_regime.size(); ++i) {
      if (table.of_regime[i].tests > 0) table.of_regime[i].print(friction::kRegimeNames[i].second);
    }
    table.few_captures.print("with one to three captures");
  }
  return 0;
}
