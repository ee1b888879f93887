// The live detector, tier by tier: time for a scan over whole tests, and the slowest single scan, which is
// one that closes a cycle. Beside it, in the same run and over the same scans, what is done with SciPy: a
// median of five, a Savitzky–Golay filter and find_peaks (cli/accuracy_report/scipy_chain.py), as a whole
// array at once and as it would have to be called live, and the raw maximum.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "cli/accuracy_report/scipy_chain.hpp"

#include "tests/support/live_trials.hpp"

namespace {

using namespace stickslip;

/// Slips of a short test.
constexpr int kShortTest = 30;
/// Slips of a pull of ten seconds, the longest of docs/promise.md.
constexpr int kPromisedTest = 190;
/// Slips of a test so long that what is done once for a test, or once for an array, counts no more.
constexpr int kLongTest = 1000;

/// 0.05 s a cycle.
test::LiveScene fast_cycles(double scan_rate_Hz, int slips = kShortTest) {
  test::LiveScene scene;
  scene.scan_rate_Hz = scan_rate_Hz;
  scene.slips = slips;
  return scene;
}

/// 2 s a cycle.
test::LiveScene slow_cycles(double scan_rate_Hz) {
  test::LiveScene scene;
  scene.scan_rate_Hz = scan_rate_Hz;
  scene.Q = 0.008;
  scene.slips = 3;
  return scene;
}

/// What costs most: slips that differ, the last of which escapes close above the threshold, so that the
/// question is asked for long.
test::LiveScene differing_cycles(double scan_rate_Hz) {
  test::LiveScene scene = fast_cycles(scan_rate_Hz);
  scene.Q = 1.0;
  scene.scatter = 0.2;
  scene.escape_Q = 2.0;  // 1.03 times Q_th of γ/2ω 0.022 (22).
  return scene;
}

/// Slips that SciPy's chain must see at once to tell of one: it takes the mean from a peak to the next, and
/// finds a peak by what falls on either side.
constexpr int kSeenAtOnce = 2;

std::vector<double> scans_of(const test::LiveScene& scene) {
  test::LiveTrial trial{scene};
  std::vector<double> scans;
  while (static_cast<std::int64_t>(scans.size()) < trial.scan_count()) scans.push_back(trial.next());
  return scans;
}

/// Is anything known of the tester before the test?
enum class Tester { kCharacterised, kUnknown };

detect::LiveSettings settings_of(const test::LiveScene& scene, detect::EstimatorTier tier, Tester tester) {
  detect::LiveSettings settings;
  settings.scan_rate_Hz = scene.scan_rate_Hz;
  settings.estimator = tier;
  if (tester == Tester::kCharacterised) settings.prior = scene.characterised();
  return settings;
}

/// The least time of many, as Python tells it of SciPy's: what else the machine does only ever adds.
void follow(benchmark::State& state, const test::LiveScene& scene, detect::EstimatorTier tier,
            Tester tester) {
  using Clock = std::chrono::steady_clock;
  const std::vector<double> scans = scans_of(scene);
  std::int64_t cycles = 0;
  double least_s = std::numeric_limits<double>::infinity();
  for (auto _ : state) {
    const auto begin = Clock::now();
    detect::LiveDetector detector{settings_of(scene, tier, tester)};
    cycles = 0;
    for (const double value : scans) cycles += detector.add(value, false) ? 1 : 0;
    benchmark::DoNotOptimize(detector);
    least_s = std::min(least_s, std::chrono::duration<double>(Clock::now() - begin).count());
  }
  state.counters["cycles"] = static_cast<double>(cycles);
  state.counters["per_scan"] = least_s / static_cast<double>(scans.size());
}

/// The slowest scan: of several runs the least for each scan, so that what else the machine does does not
/// count.
void slowest_scan(benchmark::State& state, const test::LiveScene& scene, detect::EstimatorTier tier,
                  Tester tester) {
  using Clock = std::chrono::steady_clock;
  constexpr int kRuns = 7;
  const std::vector<double> scans = scans_of(scene);
  double slowest_us = 0.0;
  for (auto _ : state) {
    std::vector<double> least_us(scans.size(), std::numeric_limits<double>::infinity());
    for (int run = 0; run < kRuns; ++run) {
      detect::LiveDetector detector{settings_of(scene, tier, tester)};
      for (std::size_t k = 0; k < scans.size(); ++k) {
        const auto begin = Clock::now();
        benchmark::DoNotOptimize(detector.add(scans[k], false));
        const std::chrono::duration<double, std::micro> took = Clock::now() - begin;
        least_us[k] = std::min(least_us[k], took.count());
      }
    }
    slowest_us = *std::max_element(least_us.begin(), least_us.end());
  }
  state.counters["slowest_scan_us"] = slowest_us;
}

void peer_raw_maximum(benchmark::State& state) {
  const std::vector<double> scans = scans_of(fast_cycles(static_cast<double>(state.range(0))));
  for (auto _ : state) benchmark::DoNotOptimize(*std::max_element(scans.begin(), scans.end()));
  state.counters["per_scan"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(scans.size()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(peer_raw_maximum)->Arg(350)->Arg(10'000);

/// Python tells the least time of many itself.
/// \return for one of the scans.
double scipy_ns_per_scan(benchmark::State& state, const test::LiveScene& scene,
                         const std::vector<double>& scans) {
  const std::vector<accuracy::TierScene> scenes{{scene.scan_rate_Hz, scene.frequency_Hz, {scans}}};
  double ns = 0.0;
  for (auto _ : state) {
    const auto outcomes = accuracy_report::run_scipy_chain(scenes);
    if (outcomes) {
      ns = outcomes->front().ns_per_scan;
    } else {
      state.SkipWithError(outcomes.error().message.c_str());
    }
  }
  return ns;
}

void peer_scipy_chain(benchmark::State& state, const test::LiveScene& scene) {
  state.counters["per_scan"] = 1e-9 * scipy_ns_per_scan(state, scene, scans_of(scene));
}

/// To tell of each slip when it has come, the chain is called anew for each, on the last ones: every scan is
/// seen so many times.
void peer_scipy_chain_live(benchmark::State& state, double scan_rate_Hz) {
  const test::LiveScene scene = fast_cycles(scan_rate_Hz);
  const std::vector<double> scans = scans_of(scene);
  const std::size_t before = scans_of(fast_cycles(scan_rate_Hz, scene.slips - kSeenAtOnce)).size();
  const std::vector<double> last{scans.begin() + static_cast<std::ptrdiff_t>(before), scans.end()};
  state.counters["per_scan"] = 1e-9 * scipy_ns_per_scan(state, scene, last) * kSeenAtOnce;
}

}  // namespace

int main(int argc, char** argv) {
  for (const auto tier : {detect::EstimatorTier::kTurningPoints, detect::EstimatorTier::kFit}) {
    const std::string tier_name{name(tier)};
    for (const double rate_Hz : {100.0, 350.0, 1000.0, 10'000.0, 100'000.0}) {
      const std::string at = tier_name + "/" + std::to_string(static_cast<int>(rate_Hz));
      for (const Tester tester : {Tester::kCharacterised, Tester::kUnknown}) {
        for (const int slips : {kShortTest, kPromisedTest, kLongTest}) {
          if (rate_Hz > 10'000.0 && slips > kShortTest) continue;
          std::string row = tester == Tester::kCharacterised ? "follow/" : "follow_unknown_tester/";
          row += at;
          if (slips > kShortTest) row.append("/").append(std::to_string(slips));
          benchmark::RegisterBenchmark(row.c_str(), [=](benchmark::State& state) {
            follow(state, fast_cycles(rate_Hz, slips), tier, tester);
          });
        }
      }
      benchmark::RegisterBenchmark(("slowest_scan/" + at).c_str(), [=](benchmark::State& state) {
        slowest_scan(state, fast_cycles(rate_Hz), tier, Tester::kCharacterised);
      })->Iterations(1);
      benchmark::RegisterBenchmark(("slowest_scan/differing_slips_uncharacterised/" + at).c_str(),
                                   [=](benchmark::State& state) {
                                     slowest_scan(state, differing_cycles(rate_Hz), tier, Tester::kUnknown);
                                   })
          ->Iterations(1);
    }
    for (const double rate_Hz : {350.0, 100'000.0}) {
      benchmark::RegisterBenchmark(
          ("slowest_scan/2s_cycle/" + tier_name + "/" + std::to_string(static_cast<int>(rate_Hz))).c_str(),
          [=](benchmark::State& state) {
            slowest_scan(state, slow_cycles(rate_Hz), tier, Tester::kCharacterised);
          })
          ->Iterations(1);
    }
  }
  for (const double rate_Hz : {100.0, 350.0, 1000.0, 10'000.0}) {
    for (const int slips : {kShortTest, kPromisedTest, kLongTest}) {
      const std::string at = std::to_string(static_cast<int>(rate_Hz)) + "/" + std::to_string(slips);
      benchmark::RegisterBenchmark(("peer_scipy_chain/" + at).c_str(), [=](benchmark::State& state) {
        peer_scipy_chain(state, fast_cycles(rate_Hz, slips));
      })->Iterations(1);
    }
    benchmark::RegisterBenchmark(
        ("peer_scipy_chain_live/" + std::to_string(static_cast<int>(rate_Hz))).c_str(),
        [=](benchmark::State& state) { peer_scipy_chain_live(state, rate_Hz); })
        ->Iterations(1);
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
