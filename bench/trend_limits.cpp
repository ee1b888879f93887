// The control charts of a tester on random histories: tests between false alarms of all seven charts, and
// tests until a shift is told, by the number of tests before it; then whole simulated tests, five for each
// history.
//
//     trend_limits [HISTORIES [SEED]]      # 4000, seed 1

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/arguments.hpp"
#include "core/signal/statistics.hpp"
#include "tests/support/record_samples.hpp"
#include "tests/support/trend_path.hpp"
#include "tests/support/trend_trials.hpp"

namespace {

using namespace stickslip;

void print_false_alarms(std::uint64_t histories, std::uint64_t seed) {
  std::vector<double> lengths;
  for (std::uint64_t i = 0; i < histories; ++i)
    lengths.push_back(static_cast<double>(test::tests_to_false_alarm(seed + i)));
  std::sort(lengths.begin(), lengths.end());
  double sum = 0.0;
  for (const double length : lengths) sum += length;
  const double mean = sum / static_cast<double>(lengths.size());
  fmt::print(
      "tests from an empty history to the first false alarm of the seven charts: mean {:.0f} +- {:.0f}, "
      "median {:.0f}, one history in ten below {:.0f}\n",
      mean, mean / std::sqrt(static_cast<double>(histories)), lengths[lengths.size() / 2],
      lengths[lengths.size() / 10]);
  // A long history without a restart but that of the alarmed chart's arms.
  constexpr int kTests = 20'000;
  std::int64_t alarms = 0;
  std::array<std::int64_t, trend::kQuantities> of_chart{};
  const std::uint64_t long_ones = std::max<std::uint64_t>(1, histories / 100);
  for (std::uint64_t i = 0; i < long_ones; ++i) {
    test::RandomHistory history{seed + 1'000'000 + i};
    trend::TesterCharts charts{"reference"};
    for (int k = 0; k < kTests; ++k) {
      for (const trend::Quantity quantity : charts.add(history.next())) {
        ++alarms;
        ++of_chart[static_cast<std::size_t>(quantity)];
        charts.restart(quantity, true);
      }
    }
  }
  const double tests = static_cast<double>(long_ones) * kTests;
  fmt::print("tests between false alarms over {} histories of {} tests: {:.0f} +- {:.0f}; of each chart:",
             long_ones, kTests, tests / static_cast<double>(std::max<std::int64_t>(1, alarms)),
             tests / std::pow(static_cast<double>(std::max<std::int64_t>(1, alarms)), 1.5));
  for (std::size_t i = 0; i < trend::kQuantities; ++i)
    fmt::print(" {} {:.0f}", trend::chart_kinds()[i].name,
               tests / static_cast<double>(std::max<std::int64_t>(1, of_chart[i])));
  fmt::print("\n");
}

/// Mean of values, of which there is one at least, and its standard error.
std::pair<double, double> mean_and_error(const std::vector<double>& values) {
  signal::RunningVariance all;
  for (const double value : values) all.add(value);
  return {all.mean, all.error_of_mean()};
}

void print_delays(std::uint64_t histories, std::uint64_t seed, trend::Quantity quantity, double shift) {
  for (const std::int64_t before : {25, 50, 100, 200, 400}) {
    std::vector<double> delays;
    std::uint64_t late = 0;
    constexpr std::int64_t kMost = 1000;
    for (std::uint64_t i = 0; i < histories; ++i) {
      const auto delay = test::tests_to_alarm(seed + i, before, {quantity, shift}, kMost);
      if (!delay) continue;
      delays.push_back(static_cast<double>(*delay));
      if (*delay >= 100) ++late;
    }
    std::sort(delays.begin(), delays.end());
    const auto [mean, error] = mean_and_error(delays);
    fmt::print("{:<9} {:>5.1f} {:>7} {:>8.1f} +- {:<5.1f} {:>6.0f} {:>9.0f} {:>14.1f}\n",
               trend::kind_of(quantity).name, shift, before, mean, error, delays[delays.size() / 2],
               delays[delays.size() * 9 / 10],
               100.0 * static_cast<double>(late) / static_cast<double>(delays.size()));
  }
}

/// What a chart can reach at best, but for some per cent: CUSUM of the log-likelihood ratio, which knows both
/// distributions. Its delay in the worst case is the least of all charts [Moustakides, Annals of Statistics
/// 14:1379-1387, 1986]. Its limit makes false alarms of the rising arm as rare as Siegmund's formula says of
/// the charts here.
void print_optimum(std::uint64_t histories, std::uint64_t seed, trend::Quantity quantity, double shift) {
  constexpr int kBefore = 200;
  const double between_false_alarms = trend::one_sided_run_length(0.0);
  // Tests to an alarm; 0: it came within the first `before` tests, which are in control.
  const auto run = [&](double limit, std::uint64_t own_seed, int before, double shift_then) {
    test::RandomHistory history{own_seed};
    double height = 0.0;
    for (std::int64_t count = 1;; ++count) {
      const double value = history.draw(quantity, count > before ? shift_then : 0.0);
      height = std::max(0.0, height + test::RandomHistory::log_likelihood_ratio(quantity, value, shift));
      if (height > limit) return std::max<std::int64_t>(0, count - before);
    }
  };
  const auto mean = [&](double limit, int before, double shift_then) {
    signal::RunningVariance lengths;
    for (std::uint64_t i = 0; i < histories; ++i) {
      const auto length = run(limit, seed + i, before, shift_then);
      if (length > 0) lengths.add(static_cast<double>(length));
    }
    return std::pair{lengths.mean, lengths.error_of_mean()};
  };
  double low = 3.0;
  double high = 10.0;
  while (high - low > 0.02) {
    const double middle = 0.5 * (low + high);
    (mean(middle, 0, 0.0).first < between_false_alarms ? low : high) = middle;
  }
  const auto [delay, error] = mean(high, kBefore, shift);
  fmt::print("{:<9} {:>5.1f} {:>8.1f} +- {:.1f}\n", trend::kind_of(quantity).name, shift, delay, error);
}

/// The shipped scene with short tests, and one setting more or less.
std::filesystem::path scene_with(const test::TemporaryFolder& folder, std::uint64_t seed,
                                 std::string_view name,
                                 const std::vector<std::pair<std::string, std::string>>& changes) {
  std::ifstream in{std::filesystem::path{STICKSLIP_SOURCE_DIR} /
                   "config/scenes/stick-slip-at-12-in-per-min.toml"};
  std::string text{std::istreambuf_iterator<char>{in}, {}};
  std::vector<std::pair<std::string, std::string>> all{{"seed = 3 ", fmt::format("seed = {} ", seed)},
                                                       {"idle = \"0.5 s\"", "idle = \"2 s\""},
                                                       {"pull = \"5 s\"", "pull = \"1.5 s\""},
                                                       {"stop = \"1 s\"", "stop = \"0.5 s\""}};
  all.insert(all.end(), changes.begin(), changes.end());
  for (const auto& [was, becomes] : all) {
    const std::size_t at = text.find(was);
    if (at == std::string::npos) throw std::runtime_error("the scene has no " + was);
    text.replace(at, was.size(), becomes);
  }
  std::filesystem::path file = folder.path() / fmt::format("{}.toml", name);
  std::ofstream{file} << text;
  return file;
}

/// Whole tests: their false alarms, and how soon omega or noise that is one standard deviation off is told.
void print_whole_path(std::uint64_t tests, std::uint64_t seed) {
  using enum trend::Quantity;
  const test::TemporaryFolder folder;
  const auto play = [&](std::string_view name, std::uint64_t own_seed, std::uint64_t count,
                        const auto& changes) {
    return test::tests_of_scene(scene_with(folder, own_seed, name, changes), static_cast<int>(count));
  };
  using Changes = std::vector<std::pair<std::string, std::string>>;
  const auto in_control = play("in-control", seed, tests, Changes{});
  trend::TesterCharts charts{"reference"};
  std::array<int, trend::kQuantities> alarms{};
  for (const trend::TestValues& test : in_control) {
    for (const trend::Quantity quantity : charts.add(test)) {
      ++alarms[static_cast<std::size_t>(quantity)];
      charts.restart(quantity, true);
    }
  }
  fmt::print(
      "\nthe whole path: {} simulated tests from scans to charts; false alarms (by Siegmund {:.1f} a "
      "chart)\n",
      in_control.size(), static_cast<double>(in_control.size()) / trend::run_length(0.0));
  for (std::size_t i = 0; i < trend::kQuantities; ++i) {
    const trend::ControlChart& chart = charts.state(static_cast<trend::Quantity>(i)).chart;
    fmt::print("{:<9} {:>7} values, mean {:.6g}, sd {:.3g}: {} false alarms\n", trend::chart_kinds()[i].name,
               chart.count(), chart.mean(), chart.standard_deviation(), alarms[i]);
  }
  const auto sd = [&charts](trend::Quantity quantity) {
    return charts.state(quantity).chart.standard_deviation();
  };
  constexpr double kTwoPi = 6.283185307179586;
  const double noise = 0.001 * (1.0 + sd(kNoise) / charts.state(kNoise).chart.mean());
  const std::array shifts{
      std::pair{kOmega, Changes{{"frequency = \"20 Hz\"",
                                 fmt::format("frequency = \"{:.9f} Hz\"", 20.0 + sd(kOmega) / kTwoPi)}}},
      std::pair{kNoise, Changes{{"sd = 0.001 ", fmt::format("sd = {:.9f} ", noise)}}}};
  constexpr std::size_t kAfter = 100;
  for (const auto& [quantity, changes] : shifts) {
    const auto shifted = play(trend::kind_of(quantity).name, seed + 1, tests / 2, changes);
    for (const std::size_t before : {std::size_t{100}, std::size_t{200}, std::size_t{400}}) {
      std::vector<double> delays;
      for (std::size_t first = 0, next = 0;
           first + before <= in_control.size() && next + kAfter <= shifted.size();
           first += before, next += kAfter) {
        trend::TesterCharts own{"reference"};
        for (std::size_t i = first; i < first + before; ++i) own.add(in_control[i]);
        if (own.state(quantity).alarm) continue;
        std::size_t count = 0;
        while (count < kAfter && !own.state(quantity).alarm) own.add(shifted[next + count++]);
        delays.push_back(static_cast<double>(count));
      }
      const auto [mean, error] = mean_and_error(delays);
      fmt::print(
          "{} shifted by one sd after {} tests: told within {:.1f} +- {:.1f} tests on average of {} "
          "histories (at most {} are waited for)\n",
          trend::kind_of(quantity).name, before, mean, error, delays.size(), kAfter);
    }
  }
}

void run(int argc, char** argv) {
  const auto histories = test::argument<std::uint64_t>(argc, argv, 1, 4000);
  const auto seed = test::argument<std::uint64_t>(argc, argv, 2, 1);
  fmt::print(
      "k {}, h {}; Siegmund: {:.0f} tests between false alarms of a chart, {:.1f} to tell one standard "
      "deviation\n",
      trend::kReferenceValue, trend::kDecisionInterval, trend::run_length(0.0), trend::run_length(1.0));
  print_false_alarms(histories, seed);
  fmt::print(
      "\ntests until a shift is told; at most 1000 are waited for\n"
      "chart     shift  tests     mean            median  9 of 10    later than\n"
      "             sd  before                              within    100 tests, %\n");
  using enum trend::Quantity;
  for (const double shift : {1.0, 2.0, 5.0}) print_delays(histories, seed, kOmega, shift);
  for (const auto quantity : {kDamping, kZero, kNoise}) print_delays(histories, seed, quantity, 1.0);
  for (const double shift : {1.0, 3.0, 5.0}) print_delays(histories, seed, kSpikes, shift);
  fmt::print(
      "\nthe same with the best chart that knows the distributions before and after the shift, and has one "
      "false alarm of its rising arm in {:.0f} tests\n",
      trend::one_sided_run_length(0.0));
  for (const auto quantity : {kOmega, kDamping, kZero, kNoise, kSpikes})
    print_optimum(histories, seed, quantity, 1.0);
  print_whole_path(5 * histories, seed);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
