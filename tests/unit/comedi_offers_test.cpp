// What a board is said to offer, boards without commands, and who may use them.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <memory>

#include "drivers/comedi/board_survey.hpp"
#include "drivers/comedi/comedi_board.hpp"
#include "drivers/comedi/comedi_errors.hpp"
#include "drivers/comedi/comedi_setup.hpp"
#include "tests/support/fake_comedi.hpp"

namespace stickslip::test {
namespace {

using daq::ReadStatus;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

class ComediOffers : public ::testing::Test {
 protected:
  ComediOffers() { world_.flags &= ~drivers::subdevice_flag::kCanCommand; }

  std::unique_ptr<daq::Board> make() {
    auto made = drivers::make_comedi_board(settings_, clock_, std::make_unique<FakeComedi>(world_, clock_));
    if (!made) throw std::runtime_error(made.error().message);
    return std::move(*made);
  }

  ManualClock clock_;
  FakeComediWorld world_;
  drivers::ComediBoardSettings settings_;
  daq::ScanBlock block_;
};

TEST_F(ComediOffers, SurveyNamesRangesReferencesAndTheRatesThatTheBoardGrants) {
  world_.flags |= drivers::subdevice_flag::kCanCommand;
  FakeComedi calls{world_, clock_};
  const drivers::BoardOffer offer = drivers::survey_board("/dev/comedi0", calls);
  ASSERT_TRUE(offer.usable()) << offer.problem;
  ASSERT_EQ(offer.subdevices.size(), 2U);
  const drivers::SubdeviceOffer& input = offer.subdevices[0];
  EXPECT_EQ(input.type, "analog input");
  EXPECT_EQ(input.channel_count, 8);
  EXPECT_EQ(input.maxdata, 65535U);
  ASSERT_EQ(input.ranges.size(), 2U);
  EXPECT_THAT(input.references, ElementsAre("ground"));
  EXPECT_EQ(input.fastest_Hz, 1e6);  // the fake's shortest period is 1 µs
  ASSERT_TRUE(input.slowest_Hz);
  EXPECT_NEAR(*input.slowest_Hz, 0.23284, 1e-5);
  EXPECT_EQ(offer.subdevices[1].type, "analog output");
  EXPECT_EQ(world_.command_count, 0);
  EXPECT_THAT(offer.configuration, HasSubstr("range_min = \"-10 V\""));
  EXPECT_THAT(offer.configuration, HasSubstr("granted: 350.0175"));
}

TEST_F(ComediOffers, SurveyOfABoardThatCannotBeOpenedSaysWhy) {
  world_.open_error = EBUSY;
  FakeComedi calls{world_, clock_};
  const drivers::BoardOffer offer = drivers::survey_board("/dev/comedi3", calls);
  EXPECT_FALSE(offer.usable());
  EXPECT_THAT(offer.problem, HasSubstr("/dev/comedi3: another program"));
}

TEST_F(ComediOffers, SurveyOfASlowBoardProposesARateThatItHas) {
  world_.flags |= drivers::subdevice_flag::kCanCommand;
  world_.shortest_period_ns = 1'000'000'000;
  FakeComedi calls{world_, clock_};
  const drivers::BoardOffer offer = drivers::survey_board("/dev/comedi0", calls);
  ASSERT_TRUE(offer.usable()) << offer.problem;
  EXPECT_THAT(offer.configuration, HasSubstr("scan_rate = \"1 Hz\""));
}

TEST(ComediDevices, AreFoundInOrderAndWithoutTheirSubdevices) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("stickslip-dev-{}", ::getpid());
  std::filesystem::create_directories(folder);
  for (const char* name : {"comedi10", "comedi2", "comedi0_subd1", "comedi", "comedix", "null"}) {
    std::ofstream{folder / name};
  }
  EXPECT_THAT(drivers::comedi_devices(folder.string()),
              ElementsAre((folder / "comedi2").string(), (folder / "comedi10").string()));
  std::filesystem::remove_all(folder);
  EXPECT_TRUE(drivers::comedi_devices(folder.string()).empty());
}

TEST_F(ComediOffers, BoardWithoutCommandsIsPolledAndSaysSo) {
  const auto board = make();
  EXPECT_EQ(board->info().acquisition, "polled");
  EXPECT_THAT(board->info().notes, HasSubstr("timed by this computer"));
  ASSERT_TRUE(board->start());
  const std::int64_t began_ns = clock_.monotonic_ns();
  std::int64_t scans = 0;
  while (scans < 3500) {
    ASSERT_EQ(board->read(block_, 100ms), ReadStatus::kScans);
    ASSERT_EQ(block_.first, scans);
    for (std::size_t i = 0; i < block_.count; ++i) {
      ASSERT_EQ(block_.raw[i], static_cast<double>(world_.reading(1 + scans++)));  // start() reads one
    }
  }
  // The last scan was read when it was due: a nanosecond of rounding.
  EXPECT_NEAR(static_cast<double>(clock_.monotonic_ns() - began_ns),
              1e9 * static_cast<double>(scans) / board->info().scan_rate_granted_Hz, 1.0);
}

TEST_F(ComediOffers, PolledScansThatWereSleptThroughAreAJumpThatIsCounted) {
  const auto board = make();
  ASSERT_TRUE(board->start());
  ASSERT_EQ(board->read(block_, 100ms), ReadStatus::kScans);
  const daq::ScanIndex end = block_.end();
  clock_.advance(10s);
  ASSERT_EQ(board->read(block_, 100ms), ReadStatus::kScans);
  // Of the 3499.9998 periods of 2857143 ns, 3499 were completed; the last of those scans can still be read.
  EXPECT_EQ(block_.first - end, 3498);
}

TEST_F(ComediOffers, PolledBoardThatGoesAwayIsMissing) {
  const auto board = make();
  ASSERT_TRUE(board->start());
  ASSERT_EQ(board->read(block_, 100ms), ReadStatus::kScans);
  world_.removed = true;
  EXPECT_EQ(board->read(block_, 100ms), ReadStatus::kBoardMissing);
  EXPECT_EQ(board->read(block_, 100ms), ReadStatus::kBoardMissing);
  EXPECT_FALSE(board->start());
}

TEST_F(ComediOffers, PolledBoardForgetsAtAStopWhyItEndedABundle) {
  const auto board = make();
  ASSERT_TRUE(board->start());
  world_.signal = [this](std::int64_t) {
    world_.used_by_another = true;  // From the second scan of the bundle on.
    return 1U;
  };
  ASSERT_EQ(board->read(block_, 100ms), ReadStatus::kScans);
  ASSERT_EQ(block_.count, 1U);
  board->stop();
  EXPECT_EQ(board->read(block_, 100ms), ReadStatus::kTimeout);
}

TEST_F(ComediOffers, PolledBoardInUseIsRefusedAtTheStart) {
  const auto board = make();
  world_.used_by_another = true;
  const auto started = board->start();
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().message, HasSubstr("another program"));
}

TEST_F(ComediOffers, CommandsThatTheBoardDoesNotHaveAreRefused) {
  settings_.acquisition = drivers::AcquisitionMode::kCommand;
  const auto made =
      drivers::make_comedi_board(settings_, clock_, std::make_unique<FakeComedi>(world_, clock_));
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message, HasSubstr("acquisition = \"polled\""));
}

TEST_F(ComediOffers, CalibrationIsChosenByFlagOrByName) {
  EXPECT_EQ(make()->info().calibration, "hard");
  world_.soft_calibration = drivers::ConversionPolynomial{{0.001, 0.00030518}, 32767.5};
  settings_.calibration = drivers::CalibrationSource::kSoft;
  EXPECT_EQ(make()->info().calibration, "soft");
  settings_.calibration = drivers::CalibrationSource::kByFlag;
  EXPECT_EQ(make()->info().calibration, "hard");
  world_.flags |= drivers::subdevice_flag::kSoftCalibrated;
  EXPECT_EQ(make()->info().calibration, "soft");
  settings_.calibration = drivers::CalibrationSource::kNone;
  const auto board = make();
  EXPECT_EQ(board->info().calibration, "none");
  EXPECT_EQ(board->info().polynomial, (std::vector<double>{-10.0, 20.0 / 65535.0}));
}

TEST_F(ComediOffers, BoardWithoutAnyConversionIsTakenByItsRange) {
  world_.has_hard_calibration = false;
  EXPECT_EQ(make()->info().calibration, "none");
  settings_.calibration = drivers::CalibrationSource::kHard;
  const auto made =
      drivers::make_comedi_board(settings_, clock_, std::make_unique<FakeComedi>(world_, clock_));
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message, HasSubstr("calibration = \"none\""));
}

TEST(ComediPermission, NamesTheGroupOfTheDeviceOrSaysThatNoneIsAllowed) {
  const auto file = std::filesystem::temp_directory_path() / fmt::format("stickslip-node-{}", ::getpid());
  std::ofstream{file} << "stands for a device";
  ASSERT_EQ(::chmod(file.c_str(), 0600), 0);
  EXPECT_THAT(drivers::explain_comedi_error(file.string(), EACCES),
              HasSubstr("no group may use it (mode 0600)"));
  ASSERT_EQ(::chmod(file.c_str(), 0660), 0);
  if (::chown(file.c_str(), static_cast<uid_t>(-1), 54321) == 0) {  // a group without a name
    EXPECT_THAT(drivers::explain_comedi_error(file.string(), EACCES), HasSubstr("it is for group 54321"));
  }
  std::filesystem::remove(file);
  EXPECT_THAT(drivers::explain_comedi_error(file.string(), EPERM), HasSubstr("it is for group iocard"));
}

}  // namespace
}  // namespace stickslip::test
