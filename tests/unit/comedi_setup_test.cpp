// What a Comedi board is asked for, what it grants, and what a person is told when it does not.
#include "drivers/comedi/comedi_setup.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "drivers/comedi/comedi_board.hpp"
#include "tests/support/fake_comedi.hpp"

namespace stickslip::test {
namespace {

using base::ErrorKind;
using drivers::ComediBoardSettings;
using ::testing::HasSubstr;
namespace trigger = drivers::trigger;

class ComediSetup : public ::testing::Test {
 protected:
  base::Result<drivers::ComediSetup> agree() {
    FakeComedi calls(world_, clock_);
    return drivers::agree_with_board(settings_, calls);
  }

  void expect_refusal(ErrorKind kind, const std::string& part) {
    const auto setup = agree();
    ASSERT_FALSE(setup);
    EXPECT_EQ(setup.error().kind, kind);
    EXPECT_THAT(setup.error().message, HasSubstr(part));
    EXPECT_THAT(setup.error().message, HasSubstr("/dev/comedi0"));
    EXPECT_THAT(setup.error().message, ::testing::Not(HasSubstr("\n")));
  }

  ManualClock clock_;
  FakeComediWorld world_;
  ComediBoardSettings settings_;
};

// 350 Hz is a period of 2857142.86 ns; the board has whole microseconds: 2857000 ns.
TEST_F(ComediSetup, GrantedRateIsTheRoundedOne) {
  const auto setup = agree();
  ASSERT_TRUE(setup);
  EXPECT_EQ(setup->command.scan_begin_argument, 2'857'000U);
  EXPECT_EQ(setup->info.scan_rate_requested_Hz, 350.0);
  EXPECT_DOUBLE_EQ(setup->info.scan_rate_granted_Hz, 1e9 / 2'857'000.0);
}

TEST_F(ComediSetup, CommandRunsWithoutEndByTheScanTimer) {
  const auto setup = agree();
  ASSERT_TRUE(setup);
  const drivers::ComediCommand& command = setup->command;
  EXPECT_EQ(command.start_source, trigger::kNow);
  EXPECT_EQ(command.scan_begin_source, trigger::kTimer);
  EXPECT_EQ(command.convert_source, trigger::kNow);
  EXPECT_EQ(command.scan_end_source, trigger::kCount);
  EXPECT_EQ(command.scan_end_argument, 1U);
  EXPECT_EQ(command.stop_source, trigger::kNone);
  EXPECT_EQ(command.flags, drivers::kWakeEndOfScan);
}

TEST_F(ComediSetup, WakeEndOfScanIsDroppedWhereTheBoardRejectsIt) {
  world_.takes_wake_end_of_scan = false;
  const auto setup = agree();
  ASSERT_TRUE(setup);
  EXPECT_EQ(setup->command.flags, 0U);
  EXPECT_EQ(setup->command.scan_begin_source, trigger::kTimer);
}

TEST_F(ComediSetup, BoardWithAConversionTimerGetsTheShortestConversion) {
  world_.has_convert_now = false;
  const auto setup = agree();
  ASSERT_TRUE(setup);
  EXPECT_EQ(setup->command.convert_source, trigger::kTimer);
  EXPECT_EQ(setup->command.convert_argument, 1000U);
  EXPECT_EQ(setup->command.scan_begin_argument, 2'857'000U);
}

TEST_F(ComediSetup, BoardWithoutAScanTimerIsTimedByItsConversions) {
  world_.has_scan_timer = false;
  const auto setup = agree();
  ASSERT_TRUE(setup);
  EXPECT_EQ(setup->command.scan_begin_source, trigger::kFollow);
  EXPECT_EQ(setup->command.convert_argument, 2'857'000U);
  EXPECT_DOUBLE_EQ(setup->info.scan_rate_granted_Hz, 1e9 / 2'857'000.0);
}

TEST_F(ComediSetup, BoardThatCannotBeTimedIsRefused) {
  world_.has_scan_timer = false;
  world_.has_convert_now = false;
  world_.rounding_ns = 1U << 31U;  // and rounds every period to nothing
  expect_refusal(ErrorKind::kFailure, "cannot acquire");
}

// Rounding to 1 ms makes 350 Hz 333.3 Hz: 4.8 % off.
TEST_F(ComediSetup, RateTooFarFromTheOneAskedIsRefused) {
  world_.rounding_ns = 1'000'000;
  expect_refusal(ErrorKind::kUsage, "333.333333");
  settings_.scan_rate_tolerance = 0.05;
  const auto setup = agree();
  ASSERT_TRUE(setup);
  EXPECT_DOUBLE_EQ(setup->info.scan_rate_granted_Hz, 1e9 / 3e6);
}

TEST_F(ComediSetup, ImpossibleRatesAreRefused) {
  for (const double rate_Hz : {0.0, -350.0, 0.2, 3e9, std::nan("")}) {
    settings_.scan_rate_Hz = rate_Hz;
    expect_refusal(ErrorKind::kUsage, "scan rate");
  }
}

TEST_F(ComediSetup, NarrowestRangeThatHoldsTheVoltagesIsTaken) {
  EXPECT_EQ(agree()->command.range, 0U);
  settings_.range_min_V = 0.0;
  settings_.range_max_V = 5.0;
  const auto setup = agree();
  ASSERT_TRUE(setup);
  EXPECT_EQ(setup->command.range, 1U);
  EXPECT_EQ(setup->info.range_min_V, -5.0);
  EXPECT_EQ(setup->info.range_max_V, 5.0);
}

TEST_F(ComediSetup, SecondChannelHasItsOwnRangeAndConversion) {
  settings_.second = {daq::SecondQuantity::kSledPosition, 3, 0.0, 4.0, 0.02, 0.5};
  const auto setup = agree();
  ASSERT_TRUE(setup) << setup.error().message;
  EXPECT_EQ(setup->command.range, 0U);
  EXPECT_EQ(setup->command.second, (drivers::ComediInput{3, 1}));
  EXPECT_EQ(setup->command.scan_end_argument, 2U);
  ASSERT_TRUE(setup->info.second);
  const daq::SecondChannel& second = *setup->info.second;
  EXPECT_EQ(second.quantity, daq::SecondQuantity::kSledPosition);
  EXPECT_EQ(second.channel, 3);
  EXPECT_EQ(second.maxdata, 65535U);
  EXPECT_EQ(second.range_max_V, 5.0);
  EXPECT_EQ(second.calibration, "hard");
  // (−5 V + 10 V · 65535/65535 − 0.5 V) · 20 mm/V
  EXPECT_DOUBLE_EQ(second.value(65535), 4.5 * 0.02);
  EXPECT_NEAR(second.step(), 10.0 / 65535.0 * 0.02, 1e-15);  // A difference of numbers of 0.1.
  EXPECT_TRUE(std::isnan(second.value(daq::SecondChannel::kNoCode)));
}

TEST_F(ComediSetup, BoardThatConvertsByATimerAloneTakesTwoConversionsAScan) {
  world_.has_scan_timer = false;
  world_.has_convert_now = false;
  settings_.second.emplace();
  const auto setup = agree();
  ASSERT_TRUE(setup) << setup.error().message;
  EXPECT_EQ(setup->command.convert_argument, 1'429'000U);  // Half of 2857143 ns, rounded to 1 us.
  EXPECT_DOUBLE_EQ(setup->info.scan_rate_granted_Hz, 1e9 / 2'858'000.0);
}

TEST_F(ComediSetup, SecondChannelThatCannotBeIsRefused) {
  settings_.second.emplace().channel = settings_.channel;
  expect_refusal(ErrorKind::kUsage, "is that of the force");
  settings_.second->channel = 8;
  expect_refusal(ErrorKind::kUsage, "channels 0 … 7");
  settings_.second->channel = 1;
  settings_.second->range_max_V = 20.0;
  expect_refusal(ErrorKind::kUsage, "it offers: -10 … 10 V, -5 … 5 V");
}

TEST_F(ComediSetup, RangesInOtherUnitsAreNotVolts) {
  world_.ranges = {{-20.0, 20.0, false}, {-5.0, 5.0, true}};
  expect_refusal(ErrorKind::kUsage, "it offers: -5 … 5 V");
}

// The board itself takes any reference without a word.
TEST_F(ComediSetup, ReferenceThatIsNotWiredIsRefused) {
  settings_.reference = drivers::AnalogReference::kDifferential;
  expect_refusal(ErrorKind::kUsage, "it offers: ground");
  EXPECT_TRUE(world_.tested.empty());
}

TEST_F(ComediSetup, ChannelBeyondTheLastIsRefused) {
  settings_.channel = 8;
  expect_refusal(ErrorKind::kUsage, "channels 0 … 7");
}

TEST_F(ComediSetup, SubdeviceThatCannotStreamIsRefused) {
  settings_.subdevice = 1;
  expect_refusal(ErrorKind::kUsage, "subdevice 1");
}

TEST_F(ComediSetup, OpeningErrorsSayWhatToDo) {
  struct Case {
    int error;
    ErrorKind kind;  ///< Who has to act.
    std::string part;
  };
  const Case cases[] = {
      {EACCES, ErrorKind::kNoPermission, "iocard"},     {EPERM, ErrorKind::kNoPermission, "iocard"},
      {EBUSY, ErrorKind::kBusy, "another program"},     {ENOENT, ErrorKind::kFailure, "load its driver"},
      {ENODEV, ErrorKind::kFailure, "no board behind"}, {ENXIO, ErrorKind::kFailure, "no board behind"},
      {EIO, ErrorKind::kFailure, "Input/output error"}};
  for (const Case& opened : cases) {
    world_.open_error = opened.error;
    expect_refusal(opened.kind, opened.part);
  }
}

TEST_F(ComediSetup, CodesBecomeVoltsByTheRange) {
  const auto setup = agree();
  ASSERT_TRUE(setup);
  EXPECT_EQ(setup->info.maxdata, 65535U);
  EXPECT_EQ(setup->info.polynomial, (std::vector<double>{-10.0, 20.0 / 65535.0}));
  EXPECT_EQ(setup->info.expansion_origin, 0.0);
}

TEST_F(ComediSetup, SoftCalibratedBoardUsesItsFile) {
  world_.flags |= drivers::subdevice_flag::kSoftCalibrated;
  world_.soft_calibration = drivers::ConversionPolynomial{{0.001, 0.00030518}, 32767.5};
  const auto setup = agree();
  ASSERT_TRUE(setup);
  EXPECT_EQ(setup->info.polynomial, (std::vector<double>{0.001, 0.00030518}));
  EXPECT_EQ(setup->info.expansion_origin, 32767.5);
}

TEST_F(ComediSetup, SoftCalibratedBoardWithoutItsFileIsRefused) {
  world_.flags |= drivers::subdevice_flag::kSoftCalibrated;
  expect_refusal(ErrorKind::kFailure, "calibration");
}

}  // namespace
}  // namespace stickslip::test
