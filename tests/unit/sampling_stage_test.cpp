#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/sim/propagator.hpp"
#include "core/sim/scene_truth.hpp"
#include "drivers/simulated/simulated_board.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/unit/scene_text.hpp"

namespace stickslip::sim {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kRate_Hz = 350.0;
const std::string kNoise = "[effects.white_noise]\nsd = 0.001\n";
const std::string kJitter = "[effects.clock_jitter]\nsd = \"100 us\"\n";
const std::string kMissing = "[effects.missing_scans]\nrate = \"2 1/s\"\nmean_length = 5\n";
const std::filesystem::path kScenes = std::filesystem::path(STICKSLIP_SOURCE_DIR) / "config" / "scenes";

/// Pulled for 20 s so slowly that it never slips, and stopped for 10 s.
const std::string kSlowPull =
    "[effects.constant_speed]\nidle = \"1 s\"\npull_speed = \"1 um/s\"\npull = \"20 s\"\nstop = \"10 s\"\n"
    "return_speed = \"1 mm/s\"\nreturn = \"0 s\"\nrest = \"0 s\"\n";

std::string slow_pull() {
  std::string text = scene_at_rest();
  return text.erase(text.find("duration"), std::string("duration = \"1 s\"\n").size()) + kSlowPull;
}

/// Scan → reading, asked for in pieces of this size.
std::map<std::int64_t, double> arrived(const Scene& scene, std::size_t piece = 64) {
  SceneRun run{scene, scene.scan_rate_Hz};
  std::map<std::int64_t, double> readings;
  std::vector<double> raw(piece);
  std::int64_t scan = run.next_scan();
  while (const std::size_t count = run.next(raw)) {
    for (std::size_t i = 0; i < count; ++i) readings[scan++] = raw[i];
    scan = run.next_scan();
  }
  return readings;
}

TEST(PropagatorAt, WholeScansAreThoseOfNext) {
  const Motion motion = motion_of(*load_scene(kScenes / "stick-slip-at-12-in-per-min.toml"));
  Propagator scans{motion, kRate_Hz};
  Propagator instants{motion, kRate_Hz};
  std::vector<double> expected(2800);
  scans.next(expected);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(instants.at({static_cast<std::int64_t>(i), 0.0}), expected[i]) << i;
  }
}

// Events are the same to rounding at any rate: 1e-12 over 8 s, as the propagator's own tests have it.
TEST(PropagatorAt, FractionsOfScansAreScansOfAFasterClock) {
  const Motion motion = motion_of(*load_scene(kScenes / "stick-slip-at-12-in-per-min.toml"));
  Propagator fast{motion, 4.0 * kRate_Hz};
  Propagator instants{motion, kRate_Hz};
  std::vector<double> expected(4 * 2800);
  fast.next(expected);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const ScanTime instant{static_cast<std::int64_t>(i / 4), static_cast<double>(i % 4) / 4.0};
    EXPECT_NEAR(instants.at(instant), expected[i], 1e-12) << i;
  }
}

TEST(ClockJitter, AForceThatDoesNotChangeDoesNotNotice) {
  const std::vector<double> steady = readings_of(slow_pull());
  const std::vector<double> jittered = readings_of(slow_pull() + kJitter);
  ASSERT_EQ(steady.size(), jittered.size());
  for (std::size_t i = 22 * 350; i < steady.size(); ++i) {  // One second after the belt has stopped.
    EXPECT_GT(steady[i], 0.1);
    EXPECT_EQ(jittered[i], steady[i]) << i;
  }
}

// While the sled sticks the force is a line, so a reading is off by its slope times the delay.
TEST(ClockJitter, MovesTheInstantsByItsStandardDeviation) {
  const Scene scene = scene_of(slow_pull());
  const double slope_V_per_s = scene.oscillator.stick_rate_per_s(1e-6, 1.0);  // The unit is 1 V.
  const std::vector<double> steady = readings_of(slow_pull());
  const std::vector<double> jittered = readings_of(slow_pull() + kJitter);
  double sum_s = 0.0;
  double squares = 0.0;
  double largest_s = 0.0;
  double count = 0.0;
  for (std::size_t i = 2 * 350; i < 20 * 350; ++i) {
    const double late_s = (jittered[i] - steady[i]) / slope_V_per_s;
    sum_s += late_s;
    squares += late_s * late_s;
    largest_s = std::max(largest_s, std::abs(late_s));
    ++count;
  }
  // Five standard deviations of a mean and of a standard deviation.
  EXPECT_NEAR(sum_s / count, 0.0, 5.0 * 1e-4 / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(squares / count), 1e-4, 5.0 * 1e-4 / std::sqrt(2.0 * count));
  EXPECT_LT(largest_s, 6.0 * 1e-4);
}

TEST(ClockRateError, IsATestAtAnotherRateThatNobodyKnowsOf) {
  const std::string error = "[effects.clock_rate_error]\nerror = \"400 ppm\"\n";
  const Scene off = scene_of(slow_pull() + error);
  const Scene right = scene_of(slow_pull());
  EXPECT_EQ(scan_count(off, kRate_Hz), scan_count(right, kRate_Hz * 1.0004));
  std::vector<double> expected(10'000);
  SceneRun{right, kRate_Hz * 1.0004}.next(expected);
  std::vector<double> found(10'000);
  SceneRun{off, kRate_Hz}.next(found);
  EXPECT_EQ(found, expected);
}

TEST(ClockRateError, TruthIsInTheTimeOfTheRecord) {
  Scene scene = *load_scene(kScenes / "stick-slip-at-12-in-per-min.toml");
  const model::TestTruth right = scene_truth(scene, kRate_Hz, 1);
  scene.clock_rate_error = ClockRateError{0.001};
  const model::TestTruth off = scene_truth(scene, kRate_Hz, 1);
  ASSERT_EQ(off.cycles.size(), right.cycles.size());
  for (std::size_t i = 0; i < off.cycles.size(); ++i) {
    EXPECT_NEAR(off.cycles[i].onset_time_s, 1.001 * right.cycles[i].onset_time_s, 1e-12);
  }
  EXPECT_NEAR(*off.oscillation_frequency_Hz, *right.oscillation_frequency_Hz, 1e-10);
}

TEST(MissingScans, TheOthersAreWhatTheyWouldHaveBeen) {
  const std::map<std::int64_t, double> all = arrived(scene_of(slow_pull() + kNoise + kJitter));
  const Scene scene = scene_of(slow_pull() + kNoise + kJitter + kMissing);
  const std::map<std::int64_t, double> some = arrived(scene);
  EXPECT_LT(some.size(), all.size());
  for (const auto& [scan, reading] : some) EXPECT_EQ(reading, all.at(scan)) << scan;
  for (const std::size_t piece : {1U, 7U, 10'000U}) EXPECT_EQ(arrived(scene, piece), some) << piece;
}

// Between bursts the waiting time is exponential with 350/2 scans, less half a scan on average for the
// rounding down; a burst has 5 scans on average. Both have standard deviations below their means.
TEST(MissingScans, BurstsAreAsFrequentAndAsLongAsAskedFor) {
  const std::map<std::int64_t, double> some = arrived(scene_of(scene_at_rest("10000 s") + kMissing));
  double bursts = 0.0;
  double missing = 0.0;
  std::int64_t next = 0;
  for (const auto& [scan, reading] : some) {
    if (scan != next) {
      ++bursts;
      missing += static_cast<double>(scan - next);
    }
    next = scan + 1;
  }
  const double cycle_scans = 175.0 - 0.5 + 5.0;
  const double expected = 3.5e6 / cycle_scans;
  // Five standard deviations, and bursts without a scan between them (1 in 175) that count as one.
  EXPECT_NEAR(bursts / expected, 1.0, 5.0 / std::sqrt(expected) + 1.0 / 175.0);
  EXPECT_NEAR(missing / expected, 5.0, 5.0 * (5.0 + 5.0 * 5.0 / cycle_scans) / std::sqrt(expected));
}

TEST(SamplingStage, ComesBetweenMotionAndSignalAndIsBuiltOnlyIfListed) {
  const Scene scene =
      scene_of(slow_pull() + kNoise + kMissing + kJitter + "[effects.clock_rate_error]\nerror = 1e-4\n");
  EXPECT_THAT(
      (SceneRun{scene, kRate_Hz}.effects()),
      ElementsAre("constant_speed", "clock_rate_error", "clock_jitter", "missing_scans", "white_noise"));
  EXPECT_THAT((SceneRun{scene_of(slow_pull()), kRate_Hz}.effects()), ElementsAre("constant_speed"));
}

TEST(SamplingStage, DoesNotAllocate) {
  SceneRun run{scene_of(slow_pull() + kNoise + kMissing + kJitter), kRate_Hz};
  std::vector<double> raw(64);
  const std::uint64_t before = test::allocation_count();
  while (run.next(raw) > 0) {
  }
  run.restart(7);
  EXPECT_EQ(test::allocation_count(), before);
}

TEST(SamplingStage, MistakesAreNamedWithPlaceValueAndLimit) {
  const std::string scene = scene_at_rest();
  EXPECT_THAT(refusal_of(scene + "[effects.clock_rate_error]\nerror = \"2 %\"\n"),
              AllOf(HasSubstr("test.toml:13"), HasSubstr("2 %"), HasSubstr("from -0.01 to 0.01")));
  EXPECT_THAT(refusal_of(scene + "[effects.clock_jitter]\nsd = \"1 ms\"\n"),
              AllOf(HasSubstr("test.toml:13"), HasSubstr("1 ms"), HasSubstr("0.000285")));  // 0.1/350
  EXPECT_THAT(refusal_of(scene + "[effects.missing_scans]\nmean_length = 0\nrate = \"1 1/s\"\n"),
              AllOf(HasSubstr("test.toml:13"), HasSubstr("from 1")));
  EXPECT_THAT(refusal_of(scene + "[effects.missing_scans]\n"), HasSubstr("rate"));
}

drivers::SimulatedTester tester_with(const std::string& text, base::Clock& clock, int repeats) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "sampling.toml";
  std::ofstream{file} << text;
  auto tester = drivers::make_simulated_tester({{file}, repeats, {}}, clock);
  if (!tester) throw std::runtime_error(tester.error().message);
  return std::move(*tester);
}

std::map<std::int64_t, double> read_all(daq::Board& board) {
  std::map<std::int64_t, double> readings;
  daq::ScanBlock block;
  std::int64_t end = 0;
  EXPECT_TRUE(board.start());
  while (board.read(block, std::chrono::hours{1}) == daq::ReadStatus::kScans) {
    EXPECT_GE(block.first, end);
    EXPECT_GT(block.count, 0U);
    for (std::uint32_t i = 0; i < block.count; ++i) readings[block.first + i] = block.raw[i];
    end = block.end();
  }
  return readings;
}

TEST(SimulatedBoardSampling, MissingScansAreJumpsOfTheIndex) {
  test::ManualClock clock;
  const std::string scene = scene_at_rest("20 s") + kNoise;
  const std::map<std::int64_t, double> all = read_all(*tester_with(scene, clock, 3).board);
  EXPECT_EQ(all.size(), 3U * 7000U);
  const std::map<std::int64_t, double> some = read_all(*tester_with(scene + kMissing, clock, 3).board);
  EXPECT_LT(some.size(), all.size());
  EXPECT_GT(some.size(), all.size() * 9 / 10);
  for (const auto& [scan, reading] : some) EXPECT_EQ(reading, all.at(scan)) << scan;
}

// The error shows in the stamps alone: 353.5 scans arrive a second where 350 are granted.
TEST(SimulatedBoardSampling, TheClockOfTheBoardIsTheOneThatIsOff) {
  test::ManualClock clock;
  const auto tester =
      tester_with(scene_at_rest("100 s") + "[effects.clock_rate_error]\nerror = 0.01\n", clock, 1);
  EXPECT_EQ(tester.board->info().scan_rate_granted_Hz, kRate_Hz);
  const std::int64_t began_ns = clock.monotonic_ns();
  const std::map<std::int64_t, double> readings = read_all(*tester.board);
  EXPECT_EQ(readings.size(), 35'350U);  // All of the scene's 100 s.
  EXPECT_NEAR(static_cast<double>(clock.monotonic_ns() - began_ns), 100e9, 1e7);
}

TEST(SamplingStage, ShippedSceneShowsAllOfIt) {
  const base::Result<Scene> scene = load_scene(kScenes / "clock-and-missing-scans.toml");
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT((SceneRun{*scene, kRate_Hz}.effects()),
              ::testing::IsSupersetOf({"clock_rate_error", "clock_jitter", "missing_scans"}));
}

}  // namespace
}  // namespace stickslip::sim
