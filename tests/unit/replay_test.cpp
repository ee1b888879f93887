#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <span>

#include "drivers/replay/replay_board.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip {
namespace {

using daq::ReadStatus;
using std::chrono_literals::operator""ms;

/// Moves only when somebody sleeps.
class HandClock final : public base::Clock {
 public:
  [[nodiscard]] std::int64_t monotonic_ns() const override { return now_ns; }
  [[nodiscard]] std::int64_t realtime_ns() const override { return now_ns + 1000; }
  void sleep_until(std::int64_t deadline_ns) override { now_ns = std::max(now_ns, deadline_ns); }

  std::int64_t now_ns = 12'345;
};

class Replay : public testing::Test {
 protected:
  HandClock clock_;
  record::Record record_ = test::sample_record();  // 1000 … 1019 and 1040 … 1059 at 350 Hz.
  drivers::Replay replay_ = drivers::make_replay(record_, clock_);
  daq::ScanBlock block_;
};

TEST_F(Replay, DeliversEveryScanWithItsIndexAndThenEnds) {
  ASSERT_TRUE(replay_.board->start());
  std::vector<daq::ScanIndex> scan;
  std::vector<double> raw;
  ReadStatus status{};
  while ((status = replay_.board->read(block_, 100ms)) != ReadStatus::kEndOfInput) {
    if (status != ReadStatus::kScans) continue;  // The gap of 20 scans is shorter than 100 ms.
    for (std::uint32_t i = 0; i < block_.count; ++i) {
      scan.push_back(block_.first + i);
      raw.push_back(block_.raw[i]);
    }
  }
  EXPECT_EQ(scan, record_.scan);
  EXPECT_EQ(raw, record_.raw);
  EXPECT_EQ(replay_.board->read(block_, 100ms), ReadStatus::kEndOfInput);
  EXPECT_EQ(block_.count, 0U);
}

// Scan i is due (i + 1)/rate after the start; the clock moves only by the board's own sleeping.
TEST_F(Replay, TakesTheTimeTheTestTookGapIncluded) {
  const std::int64_t start_ns = clock_.now_ns;
  ASSERT_TRUE(replay_.board->start());
  while (replay_.board->read(block_, 1000ms) != ReadStatus::kEndOfInput) {
  }
  const double took_s = static_cast<double>(clock_.now_ns - start_ns) * 1e-9;
  EXPECT_NEAR(took_s, 60.0 / 350.0000350000035, 1e-9);  // Times are whole nanoseconds.
}

TEST_F(Replay, KnowsTheNoiseFreeForceOfTheScansThatTheRecordHas) {
  const auto force = replay_.truth->force(990);
  ASSERT_NE(force, nullptr);
  std::array<double, 80> coefficient{};
  force->next(990, std::span{coefficient}.first(33));  // In two calls.
  force->next(1023, std::span{coefficient}.subspan(33));
  std::size_t row = 0;
  for (std::size_t i = 0; i < coefficient.size(); ++i) {
    const bool known = row < record_.scan.size() && record_.scan[row] == 990 + static_cast<daq::ScanIndex>(i);
    const double expected = known ? record_.true_coefficient[row++] : std::nan("");
    if (std::isnan(expected)) {
      EXPECT_TRUE(std::isnan(coefficient[i])) << i;
    } else {
      EXPECT_EQ(coefficient[i], expected) << i;
    }
  }
  EXPECT_EQ(row, record_.scan.size());
  EXPECT_EQ(drivers::make_replay(test::sample_imported(), clock_).truth->force(0), nullptr);
}

TEST_F(Replay, DeliversNothingBeforeItIsDue) {
  ASSERT_TRUE(replay_.board->start());
  EXPECT_EQ(replay_.board->read(block_, 2ms), ReadStatus::kTimeout);  // 1/350 s = 2.86 ms
  EXPECT_EQ(block_.count, 0U);
  EXPECT_EQ(replay_.board->read(block_, 1ms), ReadStatus::kScans);
  EXPECT_EQ(block_.count, 1U);
  EXPECT_EQ(block_.stamp.monotonic_ns, clock_.now_ns);
}

TEST_F(Replay, LateReaderGetsWholeBlocksThatNeverSpanAGap) {
  ASSERT_TRUE(replay_.board->start());
  clock_.now_ns += 1'000'000'000;
  ASSERT_EQ(replay_.board->read(block_, 0ms), ReadStatus::kScans);
  EXPECT_EQ(block_.first, 1000);
  EXPECT_EQ(block_.count, 20U);
  ASSERT_EQ(replay_.board->read(block_, 0ms), ReadStatus::kScans);
  EXPECT_EQ(block_.first, 1040);
  EXPECT_EQ(block_.count, 20U);
}

TEST_F(Replay, NotStartedItTimesOutAndAfterAStopItGoesOn) {
  EXPECT_EQ(replay_.board->read(block_, 10ms), ReadStatus::kTimeout);
  ASSERT_TRUE(replay_.board->start());
  ASSERT_EQ(replay_.board->read(block_, 10ms), ReadStatus::kScans);
  const daq::ScanIndex end = block_.end();
  replay_.board->stop();
  EXPECT_EQ(replay_.board->read(block_, 10ms), ReadStatus::kTimeout);
  ASSERT_TRUE(replay_.board->start());
  ASSERT_EQ(replay_.board->read(block_, 10ms), ReadStatus::kScans);
  EXPECT_EQ(block_.first, end);
}

TEST_F(Replay, TruthIsThatOfTheRecordRelativeToTheFirstScanAsked) {
  const auto same = replay_.truth->truth(1000, 1060);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->cycles.front().onset_time_s, 0.03);
  const auto later = replay_.truth->truth(1007, 1060);
  ASSERT_TRUE(later);
  EXPECT_NEAR(later->cycles.front().onset_time_s, 0.03 - 0.02, 1e-8);  // 7/350 s, rate off by 1e-7.
  EXPECT_FALSE(replay_.truth->truth(1060, 2000));
  EXPECT_FALSE(drivers::make_replay(test::sample_imported(), clock_).truth->truth(0, 20));
}

TEST_F(Replay, SaysThatItIsAReplayAndKeepsTheRestOfTheBoard) {
  const daq::BoardInfo& info = replay_.board->info();
  EXPECT_EQ(info.driver, "replay");
  EXPECT_EQ(info.polynomial, record_.header.board.polynomial);
  EXPECT_EQ(info.scan_rate_granted_Hz, record_.header.board.scan_rate_granted_Hz);
}

}  // namespace
}  // namespace stickslip
