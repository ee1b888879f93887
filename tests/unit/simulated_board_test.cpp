#include "drivers/simulated/simulated_board.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/daq/calibration.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::drivers {
namespace {

using daq::ReadStatus;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

const std::filesystem::path kScenes = std::filesystem::path(STICKSLIP_SOURCE_DIR) / "config" / "scenes";
const std::filesystem::path kRingDown = kScenes / "ring-down-at-12-in-per-min.toml";
const std::filesystem::path kStickSlip = kScenes / "stick-slip-at-12-in-per-min.toml";
/// Both shipped scenes last 8 s.
constexpr std::int64_t kRepetitionScans = 8 * 350;

/// Sleeping moves it.
class SleepingClock final : public base::Clock {
 public:
  [[nodiscard]] std::int64_t monotonic_ns() const override { return now_ns; }
  [[nodiscard]] std::int64_t realtime_ns() const override { return now_ns + 1'000'000'000'000; }
  void sleep_until(std::int64_t deadline_ns) override {
    if (deadline_ns > now_ns) now_ns = deadline_ns;
  }
  std::int64_t now_ns = 5'000;
};

SimulatedTester make(base::Clock& clock, int repeats = 2) {
  base::Result<SimulatedTester> tester = make_simulated_tester({{kRingDown, kStickSlip}, repeats, {}}, clock);
  if (!tester) throw std::runtime_error(tester.error().message);
  return std::move(*tester);
}

std::vector<double> read_all(daq::Board& board, std::chrono::milliseconds timeout,
                             std::size_t most = SIZE_MAX) {
  std::vector<double> raw;
  daq::ScanBlock block;
  while (raw.size() < most && board.read(block, timeout) == ReadStatus::kScans) {
    EXPECT_EQ(block.first, static_cast<std::int64_t>(raw.size()));
    raw.insert(raw.end(), block.scans().begin(), block.scans().end());
  }
  return raw;
}

SimulatedBoardSettings faulty(const SimulatedFaults& faults) {
  return {.scenes = {kRingDown}, .repeats = 0, .scan_rate_Hz = {}, .faults = faults};
}

// Friction that falls so steeply drives the sled beyond all numbers.
TEST(SimulatedBoard, MotionThatCannotBeSolvedIsAnErrorOfTheBoard) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "runaway.toml";
  std::ofstream{file} << std::ifstream{kRingDown}.rdbuf()
                      << "\n[effects.velocity_dependence]\nper_speed = \"-100 s/m\"\n";
  SleepingClock clock;
  auto tester = make_simulated_tester({{file}, 2, {}}, clock);
  ASSERT_TRUE(tester);
  daq::Board& board = *tester->board;
  daq::ScanBlock block;
  for (const base::ScanIndex begin : {base::ScanIndex{0}, kRepetitionScans}) {
    ASSERT_TRUE(board.start());
    EXPECT_EQ(board.last_error(), "");
    ASSERT_EQ(board.read(block, 1000ms), ReadStatus::kScans);
    EXPECT_EQ(block.first, begin) << "the repetition is over";
    ReadStatus status = ReadStatus::kScans;
    while ((status = board.read(block, 1000ms)) == ReadStatus::kScans) {
    }
    EXPECT_EQ(status, ReadStatus::kFailed);
    EXPECT_EQ(block.count, 0U);
    EXPECT_THAT(board.last_error(), HasSubstr("CVODE"));
    board.stop();
  }
  ASSERT_TRUE(board.start());
  EXPECT_EQ(board.read(block, 1000ms), ReadStatus::kEndOfInput);
  EXPECT_FALSE(tester->truth->truth(0, kRepetitionScans));
  auto late = make_simulated_tester(
      {.scenes = {file}, .repeats = 2, .scan_rate_Hz = {}, .first_scan = kRepetitionScans - 1}, clock);
  ASSERT_FALSE(late);
  EXPECT_THAT(late.error().message, HasSubstr("CVODE"));
}

// What is lost is drawn from the seed, and what is delivered is what the board without faults delivers there.
TEST(SimulatedBoard, AnOverrunLosesScansAndHaltsUntilStartedAgain) {
  SleepingClock clock;
  auto troubled =
      make_simulated_tester(faulty({.overruns_every_s = 10.0, .losses_every_s = 0.0, .seed = 5}), clock);
  auto sound = make_simulated_tester(faulty({}), clock);
  ASSERT_TRUE(troubled && sound);
  daq::Board& board = *troubled->board;
  ASSERT_TRUE(board.start());
  ASSERT_TRUE(sound->board->start());
  std::vector<double> whole;
  daq::ScanBlock block;
  constexpr std::size_t kScans = 350 * 200;
  while (whole.size() < kScans && sound->board->read(block, 1000ms) == ReadStatus::kScans)
    whole.insert(whole.end(), block.scans().begin(), block.scans().end());
  base::ScanIndex next = 0;
  int overruns = 0;
  base::ScanIndex longest = 0;
  while (next < static_cast<base::ScanIndex>(kScans) - 2000) {
    const ReadStatus status = board.read(block, 1000ms);
    if (status == ReadStatus::kOverrun) {
      ++overruns;
      ASSERT_TRUE(board.start());
      do {
      } while (board.read(block, 1000ms) == ReadStatus::kTimeout);
      ASSERT_GT(block.first, next) << "scans were lost";
      longest = std::max(longest, block.first - next);
    } else {
      ASSERT_EQ(status, ReadStatus::kScans);
      ASSERT_EQ(block.first, next);
    }
    for (std::size_t i = 0; i < block.count; ++i)
      ASSERT_EQ(block.raw[i], whole[static_cast<std::size_t>(block.first) + i]);
    next = block.end();
  }
  // 20 in 200 s on the average; Poisson: outside of 3 and 50 in less than one seed of 10⁵.
  EXPECT_GT(overruns, 3);
  EXPECT_LT(overruns, 50);
  // What the block held behind the loss goes with it.
  EXPECT_LE(longest, std::llround(kLongestOverrun_s * 350.0) +
                         static_cast<base::ScanIndex>(daq::ScanBlock::kMaxScans));
}

TEST(SimulatedBoard, OneThatWasStoppedTellsNoOverrun) {
  SleepingClock clock;
  auto tester =
      make_simulated_tester(faulty({.overruns_every_s = 0.5, .losses_every_s = 0.0, .seed = 5}), clock);
  ASSERT_TRUE(tester);
  daq::Board& board = *tester->board;
  daq::ScanBlock block;
  for (int i = 0; i < 500; ++i) {
    ASSERT_TRUE(board.start());
    static_cast<void>(board.read(block, 1000ms));
    board.stop();
    ASSERT_EQ(board.read(block, 1ms), ReadStatus::kTimeout);
  }
}

TEST(SimulatedBoard, OneThatWasPulledOutStaysAwayAndTheNextGoesOnByTheClock) {
  SleepingClock clock;
  SimulatedBoardSettings settings = faulty({.overruns_every_s = 0.0, .losses_every_s = 20.0, .seed = 5});
  auto first = make_simulated_tester(settings, clock);
  ASSERT_TRUE(first);
  ASSERT_TRUE(first->board->start());
  daq::RateMeter meter{350.0};
  daq::ScanBlock block;
  ReadStatus status = ReadStatus::kScans;
  while ((status = first->board->read(block, 1000ms)) == ReadStatus::kScans) meter.observe(block);
  EXPECT_EQ(status, ReadStatus::kBoardMissing);
  EXPECT_EQ(first->board->read(block, 1000ms), ReadStatus::kBoardMissing);
  EXPECT_FALSE(first->board->start());
  EXPECT_THAT(first->board->last_error(), HasSubstr("pulled out"));
  settings.continues = meter.continuation();
  ASSERT_TRUE(settings.continues);
  constexpr std::int64_t kAway_s = 60;
  clock.now_ns += kAway_s * 1'000'000'000;
  auto second = make_simulated_tester(settings, clock);
  ASSERT_TRUE(second);
  ASSERT_TRUE(second->board->start());
  ASSERT_EQ(second->board->read(block, 1000ms), ReadStatus::kScans);
  // The last anchor is a second old at most, a delivery 40 ms; then each of two roundings.
  EXPECT_NEAR(static_cast<double>(block.first - settings.continues->end), 350.0 * kAway_s,
              0.040 * 350.0 + 2.0);
}

TEST(SimulatedBoard, MayHaveBeenRunningForLong) {
  SleepingClock clock;
  constexpr base::ScanIndex kLate = (base::ScanIndex{1} << 32) - 5;
  auto late = make_simulated_tester(
      {.scenes = {kRingDown}, .repeats = 0, .scan_rate_Hz = {}, .first_scan = kLate}, clock);
  ASSERT_TRUE(late);
  ASSERT_TRUE(late->board->start());
  daq::ScanBlock block;
  base::ScanIndex next = kLate;
  while (next < kLate + 100) {
    ASSERT_EQ(late->board->read(block, 1000ms), ReadStatus::kScans);
    ASSERT_EQ(block.first, next);
    next = block.end();
  }
  const auto wrong = make_simulated_tester(
      {.scenes = {kRingDown}, .repeats = 0, .scan_rate_Hz = {}, .first_scan = -1}, clock);
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, HasSubstr("first scan -1"));
}

TEST(SimulatedBoard, AWeightHangsOnTheLoadCellWhileAFileSaysSo) {
  SleepingClock clock;
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "hanging";
  auto tester = make_simulated_tester(
      {.scenes = {kRingDown}, .repeats = 1, .scan_rate_Hz = {}, .hanging = file}, clock);
  auto plain = make_simulated_tester({.scenes = {kRingDown}, .repeats = 1, .scan_rate_Hz = {}}, clock);
  ASSERT_TRUE(tester && plain);
  daq::Board& board = *tester->board;
  daq::Board& other = *plain->board;
  ASSERT_TRUE(board.start());
  ASSERT_TRUE(other.start());
  const daq::Calibration newtons{board.info(), tester->load_cell, 1.0};
  constexpr double kGravity_m_per_s2 = 9.80665;
  daq::ScanBlock block;
  daq::ScanBlock scene;
  /// The mean of one delivery, kg; the scene goes on behind it.
  const auto felt_kg = [&] {
    EXPECT_EQ(board.read(block, 1000ms), ReadStatus::kScans);
    EXPECT_EQ(other.read(scene, 1000ms), ReadStatus::kScans);
    EXPECT_EQ(block.first, scene.first);
    double sum = 0.0;
    for (const double raw : block.scans()) sum += newtons.force_N(raw) / kGravity_m_per_s2;
    return sum / block.count;
  };
  const auto write = [&file](const char* text) { std::ofstream{file} << text; };
  static_cast<void>(felt_kg());
  EXPECT_TRUE(std::ranges::equal(block.scans(), scene.scans())) << "nothing hangs";
  // Six standard deviations of the scene's noise of 0.001 of the sled's weight in a mean of 7 scans.
  constexpr double kClose_kg = 6.0 * 0.001 * 2.331 / 2.6;
  for (const auto& [text, mass_kg] :
       {std::pair{"0.5", 0.5}, {"0", 0.0}, {"1.25 0\n", 1.25}, {"", 1.25}, {"half", 1.25}}) {
    write(text);
    EXPECT_NEAR(felt_kg(), mass_kg, kClose_kg) << '"' << text << '"';
  }
  write("1000");
  static_cast<void>(felt_kg());
  EXPECT_TRUE(newtons.saturated(block.raw[0]));
  std::filesystem::remove(file);
  static_cast<void>(felt_kg());
  EXPECT_TRUE(std::ranges::equal(block.scans(), scene.scans())) << "the scene has gone on";
}

TEST(SimulatedBoard, PlaysEachSceneRepeatedlyAsOneStreamAndEnds) {
  SleepingClock clock;
  const SimulatedTester tester = make(clock);
  ASSERT_TRUE(tester.board->start());
  const std::int64_t start_ns = clock.now_ns;
  const std::vector<double> raw = read_all(*tester.board, 100ms);
  EXPECT_EQ(raw.size(), 4U * kRepetitionScans);
  EXPECT_EQ(clock.now_ns - start_ns, 32'000'000'000);  // 4 × 8 s: scan i is due (i + 1)/rate later.
  daq::ScanBlock block;
  EXPECT_EQ(tester.board->read(block, 100ms), ReadStatus::kEndOfInput);
  EXPECT_EQ(tester.board->read(block, 100ms), ReadStatus::kEndOfInput);
  EXPECT_EQ(block.count, 0U);
}

TEST(SimulatedBoard, IsTheSameEachTimeAndRepetitionsDiffer) {
  SleepingClock clock;
  const SimulatedTester one = make(clock);
  const SimulatedTester two = make(clock);
  ASSERT_TRUE(one.board->start());
  const std::vector<double> first = read_all(*one.board, 100ms);
  ASSERT_TRUE(two.board->start());
  clock.now_ns += 10'000'000'000;  // A late reader gets full blocks of the same scans.
  EXPECT_EQ(read_all(*two.board, 100ms), first);
  const std::vector<double> noise_1(first.begin(), first.begin() + 100);
  const std::vector<double> noise_2(first.begin() + kRepetitionScans, first.begin() + kRepetitionScans + 100);
  EXPECT_NE(noise_1, noise_2);
}

TEST(SimulatedBoard, WaitsAtMostTheTimeout) {
  SleepingClock clock;
  const SimulatedTester tester = make(clock);
  daq::ScanBlock block;
  EXPECT_EQ(tester.board->read(block, 100ms), ReadStatus::kTimeout);  // Not started.
  EXPECT_EQ(clock.now_ns, 100'005'000);
  ASSERT_TRUE(tester.board->start());
  EXPECT_EQ(tester.board->read(block, 1ms), ReadStatus::kTimeout);  // A scan takes 2.86 ms.
  EXPECT_EQ(tester.board->read(block, 4ms), ReadStatus::kScans);
  EXPECT_EQ(block.count, 1U);
  // With time for it, the next scan and those of 40 ms after it; the stamp is that of the last.
  const std::int64_t first_ns = clock.now_ns;
  EXPECT_EQ(tester.board->read(block, 100ms), ReadStatus::kScans);
  EXPECT_EQ(block.count, 15U);
  EXPECT_NEAR(static_cast<double>(clock.now_ns - first_ns), 15e9 / 350.0, 1.0);
  EXPECT_EQ(block.stamp.monotonic_ns, clock.now_ns);
  EXPECT_EQ(block.stamp.realtime_ns, clock.realtime_ns());
  clock.now_ns += 1'000'000'000;
  EXPECT_EQ(tester.board->read(block, 10ms), ReadStatus::kScans);
  EXPECT_EQ(block.count, daq::ScanBlock::kMaxScans);
}

TEST(SimulatedBoard, GoesOnWithRisingIndicesAfterAStop) {
  SleepingClock clock;
  const SimulatedTester tester = make(clock);
  ASSERT_TRUE(tester.board->start());
  ASSERT_TRUE(tester.board->start());  // Does nothing.
  daq::ScanBlock block;
  ASSERT_EQ(tester.board->read(block, 10ms), ReadStatus::kScans);
  const base::ScanIndex end = block.end();
  tester.board->stop();
  tester.board->stop();
  EXPECT_EQ(tester.board->read(block, 10ms), ReadStatus::kTimeout);
  clock.now_ns += 60'000'000'000;
  ASSERT_TRUE(tester.board->start());
  ASSERT_EQ(tester.board->read(block, 10ms), ReadStatus::kScans);
  EXPECT_EQ(block.first, end);
}

TEST(SimulatedBoard, PlaysForEverWithoutRepeats) {
  SleepingClock clock;
  const SimulatedTester tester = make(clock, 0);
  ASSERT_TRUE(tester.board->start());
  EXPECT_GE(read_all(*tester.board, 100ms, 10 * kRepetitionScans).size(), 10U * kRepetitionScans);
  const auto truth = tester.truth->truth(1'000'001 * kRepetitionScans, 1'000'002 * kRepetitionScans);
  ASSERT_TRUE(truth);
  EXPECT_EQ(truth->scene_name, "stick-slip-at-12-in-per-min");
}

TEST(SimulatedBoard, ReadingsBecomeCoefficientsThroughItsOwnFacts) {
  SleepingClock clock;
  const SimulatedTester tester = make(clock, 1);
  ASSERT_TRUE(tester.board->start());
  const std::vector<double> raw = read_all(*tester.board, 100ms);
  const daq::Calibration calibration{tester.board->info(), tester.load_cell, tester.tester.normal_load_N()};
  EXPECT_EQ(tester.board->info().quantity, daq::RawQuantity::kCounts);
  EXPECT_DOUBLE_EQ(*tester.tester.pull_speed_m_per_s, 0.00508);
  double idle = 0.0;
  for (std::size_t i = 0; i < 170; ++i) idle += calibration.coefficient(raw[i]) / 170.0;
  EXPECT_NEAR(idle, 0.0, 5.0 * 0.001 / std::sqrt(170.0) + calibration.step_coefficient());
  // The ring-down has settled at K after 4 s: 0.3 ± what is left of it and five sd of the mean.
  double settled = 0.0;
  for (std::size_t i = 1750; i < 1900; ++i) settled += calibration.coefficient(raw[i]) / 150.0;
  EXPECT_NEAR(settled, 0.30, 5.0 * 0.001 / std::sqrt(150.0) + calibration.step_coefficient());
}

TEST(SimulatedTruth, IsThatOfTheRepetitionWhichTheWindowSharesMostWith) {
  SleepingClock clock;
  const SimulatedTester tester = make(clock);
  const model::TruthSource& source = *tester.truth;
  EXPECT_EQ(source.truth(0, kRepetitionScans)->scene_name, "ring-down-at-12-in-per-min");
  EXPECT_EQ(source.truth(2 * kRepetitionScans - 10, 3 * kRepetitionScans)->scene_name,
            "stick-slip-at-12-in-per-min");
  EXPECT_NE(source.truth(0, kRepetitionScans)->seed,
            source.truth(kRepetitionScans, 2 * kRepetitionScans)->seed);
  EXPECT_FALSE(source.truth(4 * kRepetitionScans, 5 * kRepetitionScans));
  EXPECT_FALSE(source.truth(100, 100));
}

TEST(SimulatedTruth, CountsTimeFromTheWindow) {
  SleepingClock clock;
  const SimulatedTester tester = make(clock);
  const auto whole = tester.truth->truth(2 * kRepetitionScans, 3 * kRepetitionScans);
  const auto part = tester.truth->truth(2 * kRepetitionScans + 35, 3 * kRepetitionScans - 70);
  ASSERT_TRUE(whole && part);
  EXPECT_NEAR(part->cycles.front().onset_time_s, whole->cycles.front().onset_time_s - 0.1, 1e-12);
  EXPECT_EQ(part->modes.front().start_s, 0.0);
  EXPECT_NEAR(part->modes.back().end_s, 7.7, 1e-12);
}

TEST(SimulatedBoard, RefusesWhatItCannotPlay) {
  SleepingClock clock;
  const auto refusal = [&](const SimulatedBoardSettings& settings) {
    const base::Result<SimulatedTester> tester = make_simulated_tester(settings, clock);
    if (tester) return std::string{};
    EXPECT_EQ(tester.error().kind, base::ErrorKind::kUsage);
    return tester.error().message;
  };
  EXPECT_THAT(refusal({{}, 1, {}}), HasSubstr("no scenes"));
  EXPECT_THAT(refusal({{kRingDown}, -1, {}}), HasSubstr("-1"));
  EXPECT_THAT(refusal({{kRingDown}, 1, 0.0}), HasSubstr("0 Hz"));
  EXPECT_THAT(refusal({{"/nonexistent.toml"}, 1, {}}), HasSubstr("/nonexistent.toml"));
}

}  // namespace
}  // namespace stickslip::drivers
