// Detector and estimators on one whole simulated test: time per scan while it runs, and for the
// whole-test fit at its end, beside the raw maximum that the tradition takes. Then that fit alone (which
// slips were captured, S, K, omega, gamma and the stick rate), beside SciPy's least squares on the same
// slips.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "io/child_process.hpp"
#include <nlohmann/json.hpp>

#include "core/analysis/slip_estimator.hpp"
#include "core/analysis/test_analysis.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/detect/slip_rule.hpp"
#include "core/model/slip_model.hpp"
#include "core/sim/scene.hpp"
#include "core/sim/scene_run.hpp"
#include "tests/support/model_course.hpp"

namespace {

using namespace stickslip;

/// Coefficients of one repetition of the shipped sticking scene, 350 Hz, with noise.
std::vector<double> one_test() {
  const auto scene = sim::load_scene(std::filesystem::path{STICKSLIP_SOURCE_DIR} /
                                     "config/scenes/stick-slip-at-12-in-per-min.toml");
  if (!scene) std::abort();
  sim::SceneRun run{*scene, 350.0};
  std::vector<double> all;
  std::array<double, 64> raw{};
  while (const std::size_t count = run.next(raw)) all.insert(all.end(), raw.begin(), raw.begin() + count);
  const double largest = *std::max_element(all.begin(), all.end());
  const double rest = all.front();
  for (double& value : all) value = 0.38 * (value - rest) / (largest - rest);
  return all;
}

void analysis_streaming(benchmark::State& state) {
  const std::vector<double> scans = one_test();
  for (auto _ : state) {
    analysis::TestAnalysis analysis{analysis::AnalysisSettings{}};
    base::ScanIndex index = 0;
    for (const double value : scans) analysis.add(index++, value, false);
    benchmark::DoNotOptimize(analysis);
  }
  state.SetItemsProcessed(state.iterations() * std::ssize(scans));
}
BENCHMARK(analysis_streaming);

void analysis_with_whole_test_fit(benchmark::State& state) {
  const std::vector<double> scans = one_test();
  double cycles = 0.0;
  for (auto _ : state) {
    analysis::TestAnalysis analysis{analysis::AnalysisSettings{}};
    base::ScanIndex index = 0;
    for (const double value : scans) analysis.add(index++, value, false);
    cycles = analysis.finish().cycle_count.value.value_or(0.0);
  }
  state.counters["cycles"] = cycles;
  state.SetItemsProcessed(state.iterations() * std::ssize(scans));
}
BENCHMARK(analysis_with_whole_test_fit);

void peer_raw_maximum(benchmark::State& state) {
  const std::vector<double> scans = one_test();
  for (auto _ : state) benchmark::DoNotOptimize(*std::max_element(scans.begin(), scans.end()));
  state.SetItemsProcessed(state.iterations() * std::ssize(scans));
}
BENCHMARK(peer_raw_maximum);

/// Regular stick-slip at 350 Hz with noise of a fiftieth of S - K.
struct RegularTest {
  static constexpr double kSigma = 0.001;

  explicit RegularTest(int slips)
      : course(test::ModelCourse::captured(0.65, slips)), trace(course.noisy(kSigma, 1)) {
    detect::FallFinder finder;
    for (const double value : trace.value) {
      if (const auto fall = finder.add(value, detect::SlipRule::kHysteresisSigmas * kSigma))
        falls.push_back(*fall);
    }
  }

  test::ModelCourse course;
  estimate::Trace trace;
  std::vector<detect::Fall> falls;
};

void fit_of_a_test(benchmark::State& state) {
  const RegularTest test{static_cast<int>(state.range(0))};
  double delta_mu = 0.0;
  for (auto _ : state) {
    const analysis::SlipEstimates found =
        analysis::estimate_slips(test.trace, test.falls, RegularTest::kSigma);
    if (!found.fit.converged) state.SkipWithError("the fit did not converge");
    delta_mu = found.windows.back().slip.S - found.windows.back().slip.K;
  }
  state.counters["delta_mu"] = delta_mu;
  state.counters["per_slip"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(test.falls.size()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(fit_of_a_test)->Arg(30)->Arg(190)->Arg(1000);

/// Each slip from the middle of the stick before it to its trough: how it ends is not its question. From a
/// guess that is off as one from turning points is.
void peer_scipy_least_squares(benchmark::State& state) {
  const RegularTest test{static_cast<int>(state.range(0))};
  nlohmann::json question;
  question["time_s"] = std::vector<double>(test.trace.time_s.begin(), test.trace.time_s.end());
  question["value"] = std::vector<double>(test.trace.value.begin(), test.trace.value.end());
  const auto& [omega, gamma, r] = test.course.shared;
  for (const estimate::SlipWindow& window : test.course.windows) {
    const model::SlipModel slip{test.course.shared, window.slip, true};
    const double trough_s = window.slip.onset_s + slip.waveform().trough_time_s();
    question["slips"].push_back(
        {{"first", window.first},
         {"end", static_cast<std::size_t>(trough_s * test::ModelCourse::kScanRate_Hz) + 1},
         {"guess",
          {window.slip.onset_s + 0.001, window.slip.S + 0.002, window.slip.K - 0.002, 1.01 * omega, gamma,
           r}}});
  }
  for (auto _ : state) {
    const auto answer = io::ask_program("/usr/bin/python3",
                                        {std::string{STICKSLIP_SOURCE_DIR} + "/bench/least_squares_peer.py"},
                                        question.dump());
    if (!answer || !*answer || (*answer)->status != 0) {
      state.SkipWithError("SciPy does not answer");
      break;
    }
    const auto json = nlohmann::json::parse((*answer)->output);
    state.counters["per_slip"] = json.at("slip_s").get<double>();
    state.counters["delta_mu"] = json.at("delta_mu").get<double>();
  }
}
BENCHMARK(peer_scipy_least_squares)->Arg(190)->Iterations(1);

}  // namespace
