// The promises of core/daq/board.hpp, one test each, kept by every kind of board alike.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/daq/board.hpp"
#include "tests/conformance/board_case.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/manual_clock.hpp"

namespace stickslip::test {
namespace {

using daq::ReadStatus;
using daq::ScanBlock;
using namespace std::chrono_literals;

constexpr std::int64_t kNanosecondsPerMillisecond = 1'000'000;
/// Reads that any board may need before it delivers or ends; more means that it never will.
constexpr int kMostReads = 100'000;

class BoardConformance : public ::testing::TestWithParam<BoardCase> {
 protected:
  void SetUp() override { rig_ = GetParam().make(clock_); }

  base::Clock& clock() { return rig_.clock ? *rig_.clock : clock_; }
  static std::int64_t lateness_ns() { return GetParam().lateness.count(); }

  daq::Board& board() { return *rig_.board; }
  void start() { ASSERT_TRUE(board().start()) << board().last_error(); }

  /// Reads on over timeouts until something else comes.
  ReadStatus next(ScanBlock& block, std::chrono::milliseconds timeout = 50ms) {
    return next(board(), block, timeout);
  }
  static ReadStatus next(daq::Board& board, ScanBlock& block, std::chrono::milliseconds timeout) {
    ReadStatus status = ReadStatus::kTimeout;
    for (int i = 0; i < kMostReads && status == ReadStatus::kTimeout; ++i)
      status = board.read(block, timeout);
    return status;
  }

  /// At least `least` readings from now on, fewer if the input ends; those of the channels alternate.
  static std::vector<double> readings(daq::Board& board, std::size_t least,
                                      std::chrono::milliseconds timeout) {
    std::vector<double> all;
    ScanBlock block;
    while (all.size() < least && next(board, block, timeout) == ReadStatus::kScans) {
      for (std::uint32_t i = 0; i < block.count; ++i) {
        all.push_back(block.raw[i]);
        if (block.has_second) all.push_back(block.second[i]);
      }
    }
    return all;
  }

  ManualClock clock_;
  BoardRig rig_;
};

/// A block is never half filled in: also where there was something in it before.
ScanBlock used_block() {
  ScanBlock block;
  block.first = 12345;
  block.count = 7;
  return block;
}

TEST_P(BoardConformance, InfoIsPossible) {
  const daq::BoardInfo& info = board().info();
  EXPECT_FALSE(info.driver.empty());
  EXPECT_FALSE(info.board_name.empty());
  EXPECT_FALSE(info.device.empty());
  EXPECT_GT(info.scan_rate_requested_Hz, 0.0);
  EXPECT_GT(info.scan_rate_granted_Hz, 0.0);
  EXPECT_TRUE(std::isfinite(info.scan_rate_granted_Hz));
  ASSERT_GE(info.polynomial.size(), 2U);
  EXPECT_NE(info.polynomial[1], 0.0);
  if (info.quantity == daq::RawQuantity::kCounts) {
    EXPECT_GT(info.maxdata, 0U);
    EXPECT_LT(info.range_min_V, info.range_max_V);
  } else {
    EXPECT_EQ(info.maxdata, 0U);
    EXPECT_EQ(info.polynomial, (std::vector<double>{0.0, 1.0}));
  }
}

TEST_P(BoardConformance, SecondChannelIsPossible) {
  const auto& second = board().info().second;
  if (!second) return;
  EXPECT_EQ(board().info().quantity, daq::RawQuantity::kCounts);
  EXPECT_GT(second->maxdata, 0U);
  EXPECT_LE(second->maxdata, static_cast<std::uint32_t>(std::numeric_limits<std::int32_t>::max()));
  ASSERT_GE(second->polynomial.size(), 2U);
  EXPECT_NE(second->polynomial[1], 0.0);
  EXPECT_NE(second->gain_per_V, 0.0);
}

TEST_P(BoardConformance, SecondChannelComesWithEveryScanOrWithNone) {
  const auto& second = board().info().second;
  start();
  ScanBlock block;
  block.has_second = !second;
  for (int i = 0; i < 200 && next(block) == ReadStatus::kScans; ++i) {
    ASSERT_EQ(block.has_second, second.has_value());
    ASSERT_EQ(block.second_codes().size(), second ? block.count : 0U);
    for (const std::int32_t code : block.second_codes()) {
      ASSERT_GE(code, 0);
      ASSERT_LE(code, static_cast<std::int64_t>(second->maxdata));
    }
  }
}

TEST_P(BoardConformance, InfoDoesNotChange) {
  const daq::BoardInfo before = board().info();
  start();
  ScanBlock block;
  ASSERT_EQ(next(block), ReadStatus::kScans);
  board().stop();
  const daq::BoardInfo& after = board().info();
  EXPECT_EQ(before.driver, after.driver);
  EXPECT_EQ(before.board_name, after.board_name);
  EXPECT_EQ(before.maxdata, after.maxdata);
  EXPECT_EQ(before.polynomial, after.polynomial);
  EXPECT_EQ(before.scan_rate_granted_Hz, after.scan_rate_granted_Hz);
}

TEST_P(BoardConformance, ReadBeforeStartTimesOut) {
  const std::int64_t began_ns = clock().monotonic_ns();
  ScanBlock block = used_block();
  EXPECT_EQ(board().read(block, 30ms), ReadStatus::kTimeout);
  EXPECT_EQ(block.count, 0U);
  const std::int64_t took_ns = clock().monotonic_ns() - began_ns;
  EXPECT_GE(took_ns, 30 * kNanosecondsPerMillisecond);
  EXPECT_LE(took_ns, 30 * kNanosecondsPerMillisecond + lateness_ns());
}

TEST_P(BoardConformance, ReadAfterStopTimesOut) {
  start();
  ScanBlock block;
  ASSERT_EQ(next(block), ReadStatus::kScans);
  board().stop();
  const std::int64_t began_ns = clock().monotonic_ns();
  block = used_block();
  EXPECT_EQ(board().read(block, 30ms), ReadStatus::kTimeout);
  EXPECT_EQ(block.count, 0U);
  const std::int64_t took_ns = clock().monotonic_ns() - began_ns;
  EXPECT_GE(took_ns, 30 * kNanosecondsPerMillisecond);
  EXPECT_LE(took_ns, 30 * kNanosecondsPerMillisecond + lateness_ns());
}

TEST_P(BoardConformance, ReadNeverTakesLongerThanItsTimeout) {
  start();
  for (const auto timeout : {0ms, 1ms, 3ms, 50ms, 1000ms}) {
    const std::int64_t began_ns = clock().monotonic_ns();
    ScanBlock block = used_block();
    const ReadStatus status = board().read(block, timeout);
    EXPECT_LE(clock().monotonic_ns() - began_ns,
              timeout.count() * kNanosecondsPerMillisecond + lateness_ns());
    EXPECT_EQ(block.count > 0, status == ReadStatus::kScans);
  }
}

TEST_P(BoardConformance, BlocksAreNeverEmptyNorOverfull) {
  start();
  ScanBlock block;
  for (int i = 0; i < 200 && next(block) == ReadStatus::kScans; ++i) {
    ASSERT_GE(block.count, 1U);
    ASSERT_LE(block.count, ScanBlock::kMaxScans);
    for (const double reading : block.scans()) ASSERT_TRUE(std::isfinite(reading));
  }
}

TEST_P(BoardConformance, IndicesAreConsecutiveWhileNothingIsLost) {
  start();
  ScanBlock block;
  ASSERT_EQ(next(block), ReadStatus::kScans);
  EXPECT_GE(block.first, 0);
  const daq::ScanIndex enough = block.end() + 200;
  while (block.end() < enough) {
    const daq::ScanIndex expected = block.end();
    if (next(block) != ReadStatus::kScans) break;
    ASSERT_EQ(block.first, expected);
  }
}

TEST_P(BoardConformance, StampsNeverRunBackwards) {
  start();
  ScanBlock block;
  daq::ClockStamp last{clock().monotonic_ns(), clock().realtime_ns()};
  for (int i = 0; i < 200 && next(block) == ReadStatus::kScans; ++i) {
    ASSERT_GE(block.stamp.monotonic_ns, last.monotonic_ns);
    ASSERT_GE(block.stamp.realtime_ns, last.realtime_ns);
    ASSERT_LE(block.stamp.monotonic_ns, clock().monotonic_ns());
    last = block.stamp;
  }
}

TEST_P(BoardConformance, ScansDoNotComeBeforeTheirTime) {
  const double period_ns = 1e9 / board().info().scan_rate_granted_Hz;
  const std::int64_t began_ns = clock().monotonic_ns();
  start();
  ScanBlock block;
  daq::ScanIndex delivered = 0;
  for (int i = 0; i < 200 && next(block) == ReadStatus::kScans; ++i) {
    delivered += block.count;
    // One period of freedom: where in its period a board samples is its own affair.
    const double earliest_ns = static_cast<double>(delivered - 1) * period_ns;
    ASSERT_GE(static_cast<double>(block.stamp.monotonic_ns - began_ns), earliest_ns - 1.0);
  }
}

TEST_P(BoardConformance, StartWhileAcquiringDoesNothing) {
  start();
  ScanBlock block;
  ASSERT_EQ(next(block), ReadStatus::kScans);
  const daq::ScanIndex end = block.end();
  start();
  ASSERT_EQ(next(block), ReadStatus::kScans);
  EXPECT_EQ(block.first, end);
}

TEST_P(BoardConformance, StopIsAllowedAtAnyTimeAnyNumberOfTimes) {
  board().stop();
  board().stop();
  start();
  board().stop();
  board().stop();
  start();
  ScanBlock block;
  EXPECT_EQ(next(block), ReadStatus::kScans);
  board().stop();
}

TEST_P(BoardConformance, IndicesGoOnRisingAcrossRestarts) {
  ScanBlock block;
  daq::ScanIndex end = 0;
  for (int i = 0; i < 3; ++i) {
    start();
    ASSERT_EQ(next(block), ReadStatus::kScans);
    ASSERT_GE(block.first, end);
    end = block.end();
    board().stop();
  }
}

TEST_P(BoardConformance, LastErrorIsEmptyWhileAllIsWell) {
  EXPECT_EQ(board().last_error(), "");
  start();
  ScanBlock block;
  ASSERT_EQ(next(block), ReadStatus::kScans);
  board().stop();
  EXPECT_EQ(board().last_error(), "");
}

// Ten thousand scans at most: enough for each path of a read to be taken, warm or cold.
TEST_P(BoardConformance, ReadDoesNotAllocate) {
  start();
  ScanBlock block;
  const std::uint64_t before = allocation_count();
  for (int i = 0; i < 1000; ++i) static_cast<void>(board().read(block, 7ms));
  EXPECT_EQ(allocation_count(), before);
}

TEST_P(BoardConformance, ReadingsDoNotDependOnHowTheyAreFetched) {
  if (!GetParam().input_repeats) GTEST_SKIP() << "the input of this board does not repeat";
  constexpr std::size_t kCount = 500;
  start();
  const std::vector<double> expected = readings(board(), kCount, 1000ms);
  ASSERT_FALSE(expected.empty());
  rig_.board.reset();  // A device serves one at a time.
  for (const auto timeout : {1ms, 5ms, 23ms}) {
    ManualClock clock;
    const BoardRig other = GetParam().make(clock);
    ASSERT_TRUE(other.board->start());
    const std::vector<double> actual = readings(*other.board, kCount, timeout);
    const std::size_t common = std::min(expected.size(), actual.size());
    EXPECT_EQ(actual.size() < kCount, expected.size() < kCount);
    EXPECT_TRUE(
        std::equal(actual.begin(), actual.begin() + static_cast<std::ptrdiff_t>(common), expected.begin()))
        << "with a timeout of " << timeout.count() << " ms";
  }
}

/// Only boards whose input comes to an end.
class BoardEnd : public BoardConformance {};

TEST_P(BoardEnd, EndOfInputRepeats) {
  start();
  ScanBlock block;
  ReadStatus status = ReadStatus::kScans;
  for (int i = 0; i < kMostReads && status == ReadStatus::kScans; ++i) status = next(block);
  ASSERT_EQ(status, ReadStatus::kEndOfInput);
  for (int i = 0; i < 3; ++i) {
    block = used_block();
    EXPECT_EQ(board().read(block, 10ms), ReadStatus::kEndOfInput);
    EXPECT_EQ(block.count, 0U);
  }
}

std::string name_of(const ::testing::TestParamInfo<BoardCase>& instance) { return instance.param.name; }

std::vector<BoardCase> all_cases() {
  std::vector<BoardCase> cases{
      comedi_case(),    polled_comedi_case(),  comedi_second_case(),   polled_comedi_second_case(),
      simulated_case(), simulated_gaps_case(), simulated_speed_case(), simulated_hanging_case(),
      replay_case(),    replay_second_case()};
  if (auto device = comedi_device_case()) cases.push_back(*std::move(device));
  if (auto device = comedi_device_second_case()) cases.push_back(*std::move(device));
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Boards, BoardConformance, ::testing::ValuesIn(all_cases()), name_of);
INSTANTIATE_TEST_SUITE_P(Boards, BoardEnd,
                         ::testing::Values(simulated_case(), simulated_gaps_case(), simulated_speed_case(),
                                           simulated_hanging_case(), replay_case(), replay_second_case()),
                         name_of);

}  // namespace
}  // namespace stickslip::test
