// The odd moments of a Comedi board; the even ones are in tests/conformance.
#include "drivers/comedi/comedi_board.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "tests/support/fake_comedi.hpp"

namespace stickslip::test {
namespace {

using daq::ReadStatus;
using daq::ScanBlock;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

class ComediBoard : public ::testing::Test {
 protected:
  void make() {
    auto made = drivers::make_comedi_board(settings_, clock_, std::make_unique<FakeComedi>(world_, clock_));
    ASSERT_TRUE(made) << made.error().message;
    board_ = std::move(*made);
  }
  void make_and_start() {
    make();
    const auto started = board_->start();
    ASSERT_TRUE(started) << started.error().message;
  }
  ReadStatus read(std::chrono::milliseconds timeout = 100ms) { return board_->read(block_, timeout); }

  /// Reads blocks until `count` readings are there.
  std::vector<double> readings(std::size_t count) {
    std::vector<double> all;
    while (all.size() < count && read() == ReadStatus::kScans) {
      all.insert(all.end(), block_.scans().begin(), block_.scans().end());
    }
    return all;
  }
  void expect_readings_in_order(const std::vector<double>& all) const {
    for (std::size_t i = 0; i < all.size(); ++i) {
      ASSERT_EQ(all[i], static_cast<double>(world_.reading(static_cast<std::int64_t>(i)))) << "scan " << i;
    }
  }

  ManualClock clock_;
  FakeComediWorld world_;
  drivers::ComediBoardSettings settings_;
  std::unique_ptr<daq::Board> board_;
  ScanBlock block_;
};

TEST_F(ComediBoard, TwoByteSamplesArriveInOrder) {
  make_and_start();
  const auto all = readings(1000);
  EXPECT_GE(all.size(), 1000U);
  expect_readings_in_order(all);
}

TEST_F(ComediBoard, FourByteSamplesArriveInOrder) {
  world_.flags |= drivers::subdevice_flag::kLargeSample;
  world_.maxdata = (1U << 24U) - 1U;
  make_and_start();
  const auto all = readings(1000);
  EXPECT_GE(all.size(), 1000U);
  expect_readings_in_order(all);
}

// 3 bytes: a sample and a half; 1 byte: never a whole one.
TEST_F(ComediBoard, SamplesCutInTwoAreJoined) {
  for (const int size : {1, 3}) {
    world_.largest_read = size;
    make_and_start();
    const auto all = readings(300);
    EXPECT_GE(all.size(), 300U);
    expect_readings_in_order(all);
  }
}

TEST_F(ComediBoard, ChannelsOfAScanStayTogetherHoweverTheyAreCut) {
  settings_.second.emplace();
  for (const unsigned large : {0U, drivers::subdevice_flag::kLargeSample}) {
    world_.flags = (world_.flags & ~drivers::subdevice_flag::kLargeSample) | large;
    for (const int size : {1, 3, 5, 1 << 20}) {
      SCOPED_TRACE(size);
      world_.largest_read = size;
      make_and_start();
      EXPECT_EQ(world_.tested.back().second, (drivers::ComediInput{1, 0}));
      std::int64_t scan = 0;
      while (scan < 300) {
        ASSERT_EQ(read(), ReadStatus::kScans);
        ASSERT_EQ(block_.second_codes().size(), block_.count);
        for (std::uint32_t i = 0; i < block_.count; ++i, ++scan) {
          ASSERT_EQ(block_.raw[i], static_cast<double>(world_.reading(scan)));
          ASSERT_EQ(block_.second[i], static_cast<std::int64_t>(world_.second_reading(scan)));
        }
      }
    }
  }
}

TEST_F(ComediBoard, PolledBoardReadsBothChannelsOfAScan) {
  settings_.second.emplace();
  settings_.acquisition = drivers::AcquisitionMode::kPolled;
  make_and_start();
  // The first reading of each was spent on finding out whether the board answers.
  std::int64_t reading = 1;
  while (reading < 300) {
    ASSERT_EQ(read(), ReadStatus::kScans);
    for (std::uint32_t i = 0; i < block_.count; ++i, ++reading) {
      ASSERT_EQ(block_.raw[i], static_cast<double>(world_.reading(reading)));
      ASSERT_EQ(block_.second[i], static_cast<std::int64_t>(world_.second_reading(reading)));
    }
  }
}

// What was cut off before a restart must not be joined with what comes after it.
TEST_F(ComediBoard, HalfASampleDoesNotSurviveARestart) {
  world_.largest_read = 3;
  make_and_start();
  ASSERT_EQ(read(), ReadStatus::kScans);
  board_->stop();
  ASSERT_TRUE(board_->start());
  expect_readings_in_order(readings(100));
}

TEST_F(ComediBoard, BufferSizeIsSetAtEachStart) {
  settings_.buffer_size = 100'000;
  make_and_start();
  EXPECT_EQ(world_.buffer_size, 102'400U);  // whole pages
  board_->stop();
  world_.buffer_size = 4096;  // by another program
  ASSERT_TRUE(board_->start());
  EXPECT_EQ(world_.buffer_size, 102'400U);
}

TEST_F(ComediBoard, OverrunIsReportedOnceAfterTheStoredScans) {
  settings_.buffer_size = 4096;
  make_and_start();
  ASSERT_EQ(read(), ReadStatus::kScans);
  const daq::ScanIndex end = block_.end();
  clock_.advance(20s);  // 7000 scans of 2 bytes against 4096 bytes

  daq::ScanIndex stored = end;
  ReadStatus status = read();
  for (; status == ReadStatus::kScans; status = read()) {
    ASSERT_EQ(block_.first, stored);
    stored = block_.end();
  }
  EXPECT_EQ(stored - end, 2048);
  EXPECT_EQ(status, ReadStatus::kOverrun);
  EXPECT_EQ(block_.count, 0U);
  EXPECT_THAT(board_->last_error(), HasSubstr("overflowed"));
  EXPECT_EQ(read(), ReadStatus::kTimeout);
}

// The index is the time base, so the scans lost must be counted by the clock. Derivation of the
// tolerance: the anchor is less than a period late, and both ends are rounded.
TEST_F(ComediBoard, RestartAfterAnOverrunCountsTheLostScansByTheClock) {
  settings_.buffer_size = 4096;
  world_.largest_read = 100;  // stored scans come in blocks that are not full
  make_and_start();
  const std::int64_t began_ns = clock_.monotonic_ns();
  ASSERT_EQ(read(), ReadStatus::kScans);
  clock_.advance(20s);
  while (read() == ReadStatus::kScans) {
  }
  clock_.advance(5s);
  ASSERT_TRUE(board_->start());
  const std::int64_t restarted_ns = clock_.monotonic_ns();
  ASSERT_EQ(read(), ReadStatus::kScans);
  const double expected =
      1e-9 * static_cast<double>(restarted_ns - began_ns) * board_->info().scan_rate_granted_Hz;
  EXPECT_NEAR(static_cast<double>(block_.first), expected, 2.0);
  EXPECT_EQ(block_.raw[0], static_cast<double>(world_.reading(0)));
  EXPECT_EQ(board_->last_error(), "");
}

// A board whose quartz is 0.1 % slow takes 60 scans fewer in a gap of 171 s than it says: the rate that was
// measured before the gap counts, not the granted one. Tolerance: as above.
TEST_F(ComediBoard, GapIsCountedByTheMeasuredRate) {
  settings_.buffer_size = 4096;
  world_.clock_error = 1e-3;
  world_.overrun_at_scan = 60 * 350;
  world_.halt = 171s;
  make_and_start();
  const std::int64_t began_ns = clock_.monotonic_ns();
  while (read() == ReadStatus::kScans) {
  }
  EXPECT_EQ(block_.count, 0U);
  ASSERT_TRUE(board_->start());
  const double elapsed_s = 1e-9 * static_cast<double>(clock_.monotonic_ns() - began_ns);
  ASSERT_EQ(read(), ReadStatus::kScans);
  const double true_rate_Hz = board_->info().scan_rate_granted_Hz / 1.001;
  EXPECT_NEAR(static_cast<double>(block_.first), elapsed_s * true_rate_Hz, 2.0);
}

// However short the halt was, something was lost, and the index has to show it.
TEST_F(ComediBoard, OverrunAlwaysLeavesAGap) {
  world_.overrun_at_scan = 20;
  make_and_start();
  daq::ScanIndex end = 0;
  for (ReadStatus status = read(); status == ReadStatus::kScans; status = read()) end = block_.end();
  ASSERT_TRUE(board_->start());
  ASSERT_EQ(read(), ReadStatus::kScans);
  EXPECT_GT(block_.first, end);
}

TEST_F(ComediBoard, NextBoardObjectGoesOnWhereTheClockSays) {
  settings_.continues = daq::Continuation{1000, {990, clock_.monotonic_ns(), 0}, 350.0};
  clock_.advance(10s);
  make_and_start();
  ASSERT_EQ(read(), ReadStatus::kScans);
  EXPECT_EQ(block_.first, 990 + 3500 + 1);  // the first scan comes one period after the start
}

// 5 s without a scan is long for a board that wakes its reader at each.
TEST_F(ComediBoard, BoardThatFallsSilentIsMissing) {
  world_.wake_interval = 10min;
  make_and_start();
  EXPECT_EQ(read(4900ms), ReadStatus::kTimeout);
  EXPECT_EQ(read(200ms), ReadStatus::kBoardMissing);
  EXPECT_THAT(board_->last_error(), HasSubstr("nothing for 5 s"));
  EXPECT_EQ(read(), ReadStatus::kBoardMissing);
}

TEST_F(ComediBoard, StampIsPromptOnlyIfTheReadHadToWait) {
  make_and_start();
  ASSERT_EQ(read(), ReadStatus::kScans);
  EXPECT_TRUE(block_.stamp.prompt);
  clock_.advance(1s);
  ASSERT_EQ(read(), ReadStatus::kScans);
  EXPECT_FALSE(block_.stamp.prompt);
}

TEST_F(ComediBoard, PauseCountsInTheIndex) {
  make_and_start();
  static_cast<void>(readings(100));
  const daq::ScanIndex end = block_.end();
  board_->stop();
  clock_.advance(60s);
  ASSERT_TRUE(board_->start());
  ASSERT_EQ(read(), ReadStatus::kScans);
  EXPECT_NEAR(static_cast<double>(block_.first - end), 60.0 * board_->info().scan_rate_granted_Hz, 1.0);
}

// poll() tells nobody that a board went: the read after it does, and no poll may be long.
TEST_F(ComediBoard, RemovedBoardIsNoticedWithinALongRead) {
  make_and_start();
  ASSERT_EQ(read(), ReadStatus::kScans);
  world_.removed = true;
  EXPECT_EQ(read(1h), ReadStatus::kBoardMissing);
  EXPECT_EQ(block_.count, 0U);
  EXPECT_EQ(read(), ReadStatus::kBoardMissing);
  EXPECT_THAT(board_->last_error(), HasSubstr("no board"));
}

// 8 periods of 2.857 ms.
TEST_F(ComediBoard, NoPollIsLongerThanAFewPeriods) {
  world_.wake_interval = 10min;  // nothing comes
  make_and_start();
  EXPECT_EQ(read(4s), ReadStatus::kTimeout);
  EXPECT_LE(world_.longest_poll, 23ms);
}

TEST_F(ComediBoard, RemovedBoardStaysMissingAfterItWasPluggedInAgain) {
  make_and_start();
  world_.removed = true;
  EXPECT_EQ(read(), ReadStatus::kBoardMissing);
  board_->stop();
  world_.removed = false;  // the file of before stays dead
  EXPECT_EQ(read(), ReadStatus::kBoardMissing);
  const auto started = board_->start();
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().message, HasSubstr("no board"));
}

TEST_F(ComediBoard, BoardRemovedBeforeTheStartIsMissing) {
  make();
  world_.removed = true;
  ASSERT_FALSE(board_->start());
  EXPECT_EQ(read(), ReadStatus::kBoardMissing);
}

// poll() says readable and read() EINVAL for ever: a naive loop would spin.
TEST_F(ComediBoard, AcquisitionEndedByAnotherHandFails) {
  make_and_start();
  ASSERT_EQ(read(), ReadStatus::kScans);
  world_.cancelled_by_another = true;
  EXPECT_EQ(read(), ReadStatus::kFailed);
  EXPECT_THAT(board_->last_error(), HasSubstr("ended by something else"));
  world_.cancelled_by_another = false;
  board_->stop();
  ASSERT_TRUE(board_->start());
  EXPECT_EQ(read(), ReadStatus::kScans);
}

TEST_F(ComediBoard, BoardInUseByAnotherProgramRefusesToStart) {
  make();
  world_.used_by_another = true;
  const auto started = board_->start();
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().kind, base::ErrorKind::kBusy);
  EXPECT_THAT(started.error().message, HasSubstr("another program"));
  EXPECT_EQ(read(), ReadStatus::kTimeout);
  world_.used_by_another = false;
  EXPECT_TRUE(board_->start());
}

TEST_F(ComediBoard, StartWhileAcquiringIssuesNoSecondCommand) {
  make_and_start();
  ASSERT_TRUE(board_->start());
  EXPECT_EQ(world_.command_count, 1);
}

}  // namespace
}  // namespace stickslip::test
