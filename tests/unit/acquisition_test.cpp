// The acquisition thread: what it never does, and what it asks of the kernel.

#include "daemon/runtime/acquisition.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/daq/latency_histogram.hpp"
#include "drivers/comedi/comedi_board.hpp"
#include "drivers/simulated/simulated_board.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/fake_comedi.hpp"

namespace stickslip::runtime {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using namespace std::chrono_literals;

/// 8 s at 350 scans/s.
const std::filesystem::path kStickSlip =
    std::filesystem::path{STICKSLIP_SOURCE_DIR} / "config/scenes/stick-slip-at-12-in-per-min.toml";

/// Notes what its thread has allocated at each call.
class Watched final : public daq::Board {
 public:
  explicit Watched(std::unique_ptr<daq::Board> board) : board_(std::move(board)) {}

  [[nodiscard]] const daq::BoardInfo& info() const noexcept override { return board_->info(); }
  [[nodiscard]] base::Result<void> start() override {
    ++starts;
    return board_->start();
  }
  [[nodiscard]] daq::ReadStatus read(daq::ScanBlock& block,
                                     std::chrono::milliseconds timeout) noexcept override {
    last = test::allocation_count();
    if (reads++ == 0) first = last;
    return board_->read(block, timeout);
  }
  void stop() noexcept override { board_->stop(); }

  std::uint64_t first = 0;
  std::uint64_t last = 0;
  int reads = 0;
  int starts = 0;

 private:
  std::unique_ptr<daq::Board> board_;
};

// From the first read to the last, over an overrun and the restart after it: nothing.
TEST(Acquisition, LoopNeverAllocates) {
  test::ManualClock clock;
  test::FakeComediWorld world;
  world.overrun_at_scan = 2000;
  world.halt = 10s;
  world.removed_at_scan = 5000;
  auto made = drivers::make_comedi_board({}, clock, std::make_unique<test::FakeComedi>(world, clock));
  ASSERT_TRUE(made) << made.error().message;
  Watched board{std::move(*made)};
  daq::ScanRing ring{daq::ScanRing::capacity_for(350.0)};
  Acquisition acquisition{board, ring, io::RealtimeSettings{0, {}, false}};
  ASSERT_TRUE(acquisition.start());
  while (!acquisition.ended()) acquisition.wait();
  EXPECT_EQ(*acquisition.ended(), Acquisition::End::kBoardMissing);
  EXPECT_EQ(board.starts, 2);
  EXPECT_GT(board.reads, 1000);
  EXPECT_EQ(board.last, board.first);
}

// Each block says what happened before it, so that nobody has to guess from counters that ran ahead.
TEST(Acquisition, BlocksCarryTheHaltsBeforeThem) {
  test::ManualClock clock;
  test::FakeComediWorld world;
  world.overrun_at_scan = 100;
  world.removed_at_scan = 200;
  auto made = drivers::make_comedi_board({}, clock, std::make_unique<test::FakeComedi>(world, clock));
  ASSERT_TRUE(made) << made.error().message;
  daq::ScanRing ring{1000};
  Acquisition acquisition{**made, ring, io::RealtimeSettings{0, {}, false}};
  ASSERT_TRUE(acquisition.start());
  while (!acquisition.ended()) acquisition.wait();
  std::vector<daq::ScanBlock> blocks(1000);
  blocks.resize(ring.pop(blocks.data(), blocks.size()));
  ASSERT_FALSE(blocks.empty());
  for (const daq::ScanBlock& block : blocks) EXPECT_EQ(block.overrun_count, block.first < 100 ? 0U : 1U);
  EXPECT_EQ(blocks.back().overrun_count, 1U);
}

// A source that can wait loses nothing to a ring of four blocks, however seldom it is emptied.
TEST(Acquisition, WaitsForAFullRingWhereTheSourceCanWait) {
  test::ManualClock clock;
  auto tester = drivers::make_simulated_tester({{kStickSlip}, 1, {}}, clock);
  ASSERT_TRUE(tester) << tester.error().message;
  daq::ScanRing ring{4};
  Acquisition acquisition{*tester->board, ring, io::RealtimeSettings{0, {}, false}, FullRing::kWait};
  ASSERT_TRUE(acquisition.start());
  std::vector<daq::ScanBlock> blocks(4);
  daq::ScanIndex next = 0;
  for (bool ended = false; !ended;) {
    acquisition.wait();
    ended = acquisition.ended().has_value();
    // All of a full ring at a time, then nothing for as long as it takes to be full again.
    while (!ended && ring.has_room() && !acquisition.ended()) std::this_thread::yield();
    while (const std::size_t count = ring.pop(blocks.data(), blocks.size())) {
      acquisition.made_room();
      for (const daq::ScanBlock& block : std::span{blocks}.first(count)) {
        EXPECT_EQ(block.first, next);
        EXPECT_EQ(block.dropped_scan_count, 0U);
        next = block.end();
      }
    }
  }
  EXPECT_EQ(*acquisition.ended(), Acquisition::End::kEndOfInput);
  EXPECT_EQ(next, 8 * 350);  // The whole scene.
  EXPECT_EQ(ring.dropped_scan_count(), 0U);
}

TEST(Acquisition, StopsWhileItWaitsForTheRing) {
  test::ManualClock clock;
  auto tester = drivers::make_simulated_tester({{kStickSlip}, 0, {}}, clock);
  ASSERT_TRUE(tester) << tester.error().message;
  daq::ScanRing ring{4};
  Acquisition acquisition{*tester->board, ring, io::RealtimeSettings{0, {}, false}, FullRing::kWait};
  ASSERT_TRUE(acquisition.start());
  while (ring.has_room()) std::this_thread::yield();
  acquisition.request_stop();
  while (!acquisition.ended()) acquisition.wait();
  EXPECT_EQ(*acquisition.ended(), Acquisition::End::kStopped);
}

TEST(ScanRing, IsEmptyAfterItsPagesWereTouched) {
  daq::ScanRing ring{3};
  ring.touch();
  EXPECT_TRUE(ring.has_room());
  EXPECT_EQ(ring.dropped_scan_count(), 0U);
  daq::ScanBlock block;
  EXPECT_EQ(ring.pop(&block, 1), 0U);
  for (daq::ScanIndex first = 0; first < 3; ++first) {
    block.first = first;
    EXPECT_TRUE(ring.push(block));
  }
  EXPECT_FALSE(ring.has_room());
}

TEST(Realtime, RefusalIsToldAndNotFatal) {
  // Above the highest that there is: refused to everybody.
  const std::string told = use_realtime_scheduling({1000, {}, false});
  EXPECT_THAT(told, HasSubstr("SCHED_FIFO 1000 refused: "));
  EXPECT_EQ(use_realtime_scheduling({0, {}, false}), "SCHED_OTHER");
  EXPECT_THAT(use_realtime_scheduling({0, 1023, false}), HasSubstr("any processor (1023 refused: "));
}

/// Runs in a process of its own: without the rights of root, with this limit.
[[noreturn]] void ask_as_nobody(rlim_t priority_limit) {
  const rlimit limit{priority_limit, priority_limit};
  constexpr uid_t kNobody = 65534;
  if (::setrlimit(RLIMIT_RTPRIO, &limit) != 0 || (::geteuid() == 0 && ::setuid(kNobody) != 0)) {
    std::fputs("the limit cannot be set here", stderr);
    std::_Exit(0);
  }
  std::fputs(use_realtime_scheduling({50, {}, false}).c_str(), stderr);
  std::_Exit(0);
}

TEST(RealtimeDeathTest, WithoutPermissionTheThreadGoesOnAsItIs) {
  EXPECT_EXIT(ask_as_nobody(0), testing::ExitedWithCode(0), "SCHED_OTHER .SCHED_FIFO 50 refused");
}

TEST(RealtimeDeathTest, LowerPriorityIsTakenWhereOnlyThatIsAllowed) {
  EXPECT_EXIT(ask_as_nobody(10), testing::ExitedWithCode(0),
              "SCHED_FIFO 10 .50 refused|the limit cannot be set here");
}

TEST(LatencyHistogram, BinsAreOctavesAndNothingIsLost) {
  daq::LatencyHistogram latency;
  latency.add(-5.0);      // the reference itself was late
  latency.add(15'999.0);  // below 16 µs
  latency.add(16'000.0);  // the limit belongs to the next bin
  latency.add(1e10);      // 10 s
  EXPECT_EQ(latency.counts()[0], 2U);
  EXPECT_EQ(latency.counts()[1], 1U);
  EXPECT_EQ(latency.counts()[daq::LatencyHistogram::kBins - 1], 1U);
  EXPECT_EQ(latency.largest_s(), 10.0);
  EXPECT_EQ(daq::LatencyHistogram::limit_s(0), 16e-6);
  EXPECT_EQ(daq::LatencyHistogram::limit_s(1), 32e-6);
}

}  // namespace
}  // namespace stickslip::runtime
