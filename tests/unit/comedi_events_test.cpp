// What the kernel was seen to do on comedi_test (Debian 12, Linux 6.1), line by line, and what this driver
// makes of it. The fake table answers as the line says; each test first shows that it does.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>

#include "drivers/comedi/comedi_board.hpp"
#include "drivers/comedi/comedi_setup.hpp"
#include "tests/support/fake_comedi.hpp"

namespace stickslip::test {
namespace {

using daq::ReadStatus;
using drivers::ComediCommand;
using ::testing::HasSubstr;
namespace trigger = drivers::trigger;
using namespace std::chrono_literals;

class ComediEvents : public ::testing::Test {
 protected:
  ComediEvents() {
    good_.start_source = trigger::kNow;
    good_.scan_begin_source = trigger::kTimer;
    good_.scan_begin_argument = 2'857'000;
    good_.convert_source = trigger::kNow;
    good_.scan_end_source = trigger::kCount;
    good_.scan_end_argument = 1;
    good_.stop_source = trigger::kNone;
  }

  std::unique_ptr<daq::Board> make() {
    auto made = drivers::make_comedi_board(settings_, clock_, std::make_unique<FakeComedi>(world_, clock_));
    if (!made) throw std::runtime_error(made.error().message);
    return std::move(*made);
  }
  std::unique_ptr<daq::Board> make_started() {
    auto board = make();
    if (const auto started = board->start(); !started) throw std::runtime_error(started.error().message);
    return board;
  }
  std::string refusal() {
    const auto made =
        drivers::make_comedi_board(settings_, clock_, std::make_unique<FakeComedi>(world_, clock_));
    return made ? "" : made.error().message;
  }
  ReadStatus read(daq::Board& board) { return board.read(block_, 100ms); }

  ManualClock clock_;
  FakeComediWorld world_;
  FakeComedi calls_{world_, clock_};
  drivers::ComediBoardSettings settings_;
  ComediCommand good_;
  daq::ScanBlock block_;
  std::array<std::byte, 1 << 16> bytes_{};
};

TEST_F(ComediEvents, CommandTest0TakesItAsItIs) {
  ComediCommand asked = good_;
  EXPECT_EQ(calls_.command_test(asked), 0);
  EXPECT_EQ(asked, good_);
  EXPECT_EQ(make()->info().scan_rate_granted_Hz, 1e9 / 2'857'000.0);
}

TEST_F(ComediEvents, CommandTest1UnsupportedSourceIsZeroedAndNotAskedAgain) {
  world_.has_scan_timer = false;
  ComediCommand asked = good_;
  EXPECT_EQ(calls_.command_test(asked), 1);
  EXPECT_EQ(asked.scan_begin_source, 0U);
  world_.tested.clear();
  EXPECT_TRUE(make()->start());  // by the conversion timer
  const auto asks =
      std::count_if(world_.tested.begin(), world_.tested.end(), [](const ComediCommand& command) {
        return command.scan_begin_source == trigger::kTimer && command.convert_source == trigger::kNow;
      });
  EXPECT_LE(asks, 2);  // with and without waking at each scan, once each
}

TEST_F(ComediEvents, CommandTest2ConflictIsUnchangedAndFallsBack) {
  world_.takes_wake_end_of_scan = false;
  ComediCommand asked = good_;
  asked.flags = drivers::kWakeEndOfScan;
  const ComediCommand before = asked;
  EXPECT_EQ(calls_.command_test(asked), 2);
  EXPECT_EQ(asked, before);
  auto board = make_started();
  EXPECT_EQ(read(*board), ReadStatus::kScans);
}

TEST_F(ComediEvents, CommandTest3ClampsAndTheNextCallTakesIt) {
  ComediCommand asked = good_;
  asked.scan_begin_argument = 100;
  asked.scan_end_argument = 7;
  EXPECT_EQ(calls_.command_test(asked), 3);
  EXPECT_EQ(asked.scan_begin_argument, 1000U);
  EXPECT_EQ(asked.scan_end_argument, 1U);
  EXPECT_EQ(calls_.command_test(asked), 0);
  settings_.scan_rate_Hz = 1e7;  // 100 ns
  EXPECT_THAT(refusal(), HasSubstr("nearest that the board grants is 1000000 Hz"));
}

TEST_F(ComediEvents, CommandTest4RoundsAndTheNextCallTakesIt) {
  ComediCommand asked = good_;
  asked.scan_begin_argument = 2'857'142;
  EXPECT_EQ(calls_.command_test(asked), 4);
  EXPECT_EQ(asked.scan_begin_argument, 2'857'000U);
  EXPECT_EQ(calls_.command_test(asked), 0);
  const auto board = make();
  EXPECT_NEAR(board->info().scan_rate_granted_Hz, 350.0175, 5e-5);  // as printed in the table
  EXPECT_THAT(board->info().notes, HasSubstr("scan_begin_arg 2857143 -> 2857000"));
}

TEST_F(ComediEvents, CommandTestOfABadChannelIsEinvalAndRefusedBeforeWithWhatThereIs) {
  ComediCommand asked = good_;
  asked.channel = 8;
  EXPECT_EQ(calls_.command_test(asked), -EINVAL);
  world_.tested.clear();
  settings_.channel = 8;
  EXPECT_THAT(refusal(), HasSubstr("channels 0 … 7"));
  EXPECT_TRUE(world_.tested.empty());
}

TEST_F(ComediEvents, CommandTestOfABadRangeIsEinvalAndRefusedBeforeWithWhatThereIs) {
  ComediCommand asked = good_;
  asked.range = 2;
  EXPECT_EQ(calls_.command_test(asked), -EINVAL);
  settings_.range_max_V = 20.0;
  EXPECT_THAT(refusal(), HasSubstr("it offers: -10 … 10 V, -5 … 5 V"));
}

TEST_F(ComediEvents, CommandTestOfNoSuchSubdeviceIsEnodevAndRefused) {
  ComediCommand asked = good_;
  asked.subdevice = 5;
  EXPECT_EQ(calls_.command_test(asked), -ENODEV);
  settings_.subdevice = 5;
  EXPECT_THAT(refusal(), HasSubstr("subdevice 5"));
}

TEST_F(ComediEvents, WrongReferenceIsAcceptedByTheBoardAndRefusedByUs) {
  ComediCommand asked = good_;
  asked.reference = drivers::AnalogReference::kDifferential;
  EXPECT_EQ(calls_.command_test(asked), 0);
  settings_.reference = drivers::AnalogReference::kDifferential;
  EXPECT_THAT(refusal(), HasSubstr("it offers: ground"));
}

TEST_F(ComediEvents, CommandUnroundedIsEagainAndNeverSent) {
  ComediCommand asked = good_;
  asked.scan_begin_argument = 2'857'142;
  EXPECT_EQ(calls_.command(asked), -EAGAIN);
  EXPECT_TRUE(make()->start());
}

// CMDF_PRIORITY is accepted by the test and refused (EPERM) by the command.
TEST_F(ComediEvents, PriorityIsNeverAskedFor) {
  ComediCommand asked = good_;
  asked.flags = FakeComedi::kPriority;
  EXPECT_EQ(calls_.command_test(asked), 0);
  EXPECT_EQ(calls_.command(asked), -EPERM);
  world_.tested.clear();
  EXPECT_TRUE(make()->start());
  for (const ComediCommand& command : world_.tested) EXPECT_EQ(command.flags & FakeComedi::kPriority, 0U);
}

TEST_F(ComediEvents, ReadAtOnceIsEagainAndATimeoutOfZeroReturns) {
  ASSERT_EQ(calls_.command(good_), 0);
  EXPECT_EQ(calls_.read(bytes_), -EAGAIN);
  calls_.close();
  auto board = make_started();
  EXPECT_EQ(board->read(block_, 0ms), ReadStatus::kTimeout);
}

TEST_F(ComediEvents, ReadWithoutACommandIsEinvalWhilePollSaysReadableAndDoesNotSpin) {
  EXPECT_EQ(calls_.poll(10ms), 1);
  EXPECT_EQ(calls_.read(bytes_), -EINVAL);
  auto board = make_started();
  world_.cancelled_by_another = true;
  EXPECT_EQ(read(*board), ReadStatus::kFailed);
  const auto began_ns = clock_.monotonic_ns();
  EXPECT_EQ(read(*board), ReadStatus::kTimeout);  // waits, asks nothing
  EXPECT_EQ(clock_.monotonic_ns() - began_ns, 100'000'000);
}

// 100 samples, then 0 once, then EINVAL: a command that ends by itself is not ours.
TEST_F(ComediEvents, StopCountEndsWithZeroAndIsReported) {
  world_.ends_after_scans = 100;
  auto board = make_started();
  std::size_t scans = 0;
  ReadStatus status = read(*board);
  for (; status == ReadStatus::kScans; status = read(*board)) scans += block_.count;
  EXPECT_EQ(scans, 100U);
  EXPECT_EQ(status, ReadStatus::kFailed);
  EXPECT_THAT(board->last_error(), HasSubstr("ended by something else"));
}

TEST_F(ComediEvents, OverrunHandsOutWhatIsStoredThenEpipeOnceThenEinval) {
  ASSERT_GT(calls_.set_buffer_size(0, 4096), 0);
  ComediCommand fast = good_;
  fast.scan_begin_argument = 1'000'000;
  ASSERT_EQ(calls_.command(fast), 0);
  clock_.advance(5s);
  EXPECT_EQ(calls_.poll(0ms), 1);
  EXPECT_EQ(calls_.read(bytes_), 4096);  // 2048 samples
  EXPECT_EQ(calls_.read(bytes_), -EPIPE);
  EXPECT_EQ(calls_.read(bytes_), -EINVAL);
  EXPECT_EQ(calls_.command(fast), 0);  // plain, after EPIPE was read
}

TEST_F(ComediEvents, RestartBeforeEpipeIsReadIsEbusyUntilCancelledWhichWeAlwaysDo) {
  ASSERT_GT(calls_.set_buffer_size(0, 4096), 0);
  ASSERT_EQ(calls_.command(good_), 0);
  clock_.advance(60s);
  EXPECT_EQ(calls_.poll(0ms), 1);
  EXPECT_EQ(calls_.command(good_), -EBUSY);
  EXPECT_EQ(calls_.cancel(0), 0);
  EXPECT_EQ(calls_.command(good_), 0);
}

TEST_F(ComediEvents, CancelAndRestartWorksAtOnceAndLosesWhatWasNotRead) {
  auto board = make_started();
  for (int cycle = 0; cycle < 200; ++cycle) {
    clock_.advance(50ms);
    board->stop();
    ASSERT_TRUE(board->start());
    ASSERT_EQ(read(*board), ReadStatus::kScans);
    EXPECT_EQ(block_.raw[0], static_cast<double>(world_.reading(0)));
  }
}

TEST_F(ComediEvents, SecondCommandIsEbusyAndNeverSent) {
  ASSERT_EQ(calls_.command(good_), 0);
  EXPECT_EQ(calls_.command(good_), -EBUSY);
  calls_.close();
  auto board = make_started();
  EXPECT_TRUE(board->start());
  EXPECT_EQ(world_.command_count, 2);
}

TEST_F(ComediEvents, SecondProcessMayOpenAndTestButNotAcquire) {
  world_.used_by_another = true;
  EXPECT_EQ(calls_.open("/dev/comedi0"), 0);
  ComediCommand asked = good_;
  EXPECT_EQ(calls_.command_test(asked), 0);
  EXPECT_EQ(calls_.read(bytes_), -EINVAL);
  EXPECT_EQ(calls_.cancel(0), -EBUSY);
  EXPECT_EQ(calls_.set_buffer_size(0, 4096), -EBUSY);
  EXPECT_EQ(calls_.command(good_), -EBUSY);
  const auto started = make()->start();
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().message, HasSubstr("another program is using it"));
}

TEST_F(ComediEvents, LockOfAnotherProgramIsEaccesAndSaysNotThePermission) {
  world_.locked_by_another = true;
  EXPECT_EQ(calls_.command(good_), -EACCES);
  const auto started = make()->start();
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().message, HasSubstr("locked by another program"));
}

TEST_F(ComediEvents, OwnerKilledReleasesTheBoardAtOnce) {
  auto board = make();
  world_.used_by_another = true;
  ASSERT_FALSE(board->start());
  world_.used_by_another = false;
  EXPECT_TRUE(board->start());
}

TEST_F(ComediEvents, RemovedBoardIsEnodevWhilePollStaysSilent) {
  ASSERT_EQ(calls_.command(good_), 0);
  world_.removed = true;
  EXPECT_EQ(calls_.poll(1s), 0);
  EXPECT_EQ(calls_.read(bytes_), -ENODEV);
  EXPECT_EQ(calls_.command(good_), -ENODEV);
  EXPECT_EQ(calls_.cancel(0), -ENODEV);
  world_.removed = false;
  auto board = make_started();
  world_.removed = true;
  EXPECT_EQ(read(*board), ReadStatus::kBoardMissing);
}

TEST_F(ComediEvents, OldFileStaysDeadAfterReplugAndANewOpenWorks) {
  auto old = make_started();
  world_.removed = true;
  ASSERT_EQ(read(*old), ReadStatus::kBoardMissing);
  world_.removed = false;
  EXPECT_FALSE(old->start());
  auto fresh = make_started();
  EXPECT_EQ(read(*fresh), ReadStatus::kScans);
}

}  // namespace
}  // namespace stickslip::test
