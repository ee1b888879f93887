// A board that comes back under another device file: found by name, serial number or place; and where it is
// not there, the others are named.
#include "drivers/comedi/board_search.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "drivers/comedi/board_place.hpp"
#include "drivers/comedi/board_survey.hpp"
#include "drivers/comedi/comedi_setup.hpp"
#include "tests/support/fake_comedi.hpp"

namespace stickslip::test {
namespace {

using base::ErrorKind;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class BoardSearch : public ::testing::Test {
 protected:
  BoardSearch() {
    world_.boards["/dev/comedi0"] = {"usb-1208fs", {"01A2", "pci-0000:00:14.0-usb-0:1:1.0"}};
    world_.boards["/dev/comedi1"] = {"usb-1208fs", {"77B0", "pci-0000:00:14.0-usb-0:2:1.0"}};
    world_.boards["/dev/comedi2"] = {"das1602/16", {"", "pci-0000:00:05.0"}};
  }

  base::Result<drivers::ComediSetup> agree() {
    FakeComedi calls{world_, clock_};
    return drivers::agree_with_board(settings_, calls);
  }

  std::string device() {
    const auto setup = agree();
    return setup ? setup->info.device : setup.error().message;
  }

  ManualClock clock_;
  FakeComediWorld world_;
  drivers::ComediBoardSettings settings_;
};

TEST_F(BoardSearch, WithoutAChoiceThePathIsTheBoard) {
  const auto setup = agree();
  ASSERT_TRUE(setup) << setup.error().message;
  EXPECT_EQ(setup->info.device, "/dev/comedi0");
  EXPECT_EQ(setup->info.board_name, "usb-1208fs (fake)");
  EXPECT_EQ(setup->info.serial, "01A2");
  EXPECT_EQ(setup->info.bus_path, "pci-0000:00:14.0-usb-0:1:1.0");
}

TEST_F(BoardSearch, EachKeyAloneFindsItsBoardUnderAnyDeviceFile) {
  settings_.choice = {"das1602/16", "", ""};
  EXPECT_EQ(device(), "/dev/comedi2");
  settings_.choice = {"", "77B0", ""};
  EXPECT_EQ(device(), "/dev/comedi1");
  settings_.choice = {"", "", "pci-0000:00:14.0-usb-0:1:1.0"};
  EXPECT_EQ(device(), "/dev/comedi0");
  std::swap(world_.boards["/dev/comedi0"], world_.boards["/dev/comedi2"]);
  EXPECT_EQ(device(), "/dev/comedi2");
}

TEST_F(BoardSearch, AllKeysMustApply) {
  settings_.choice = {"das1602/16", "77B0", ""};
  const auto setup = agree();
  ASSERT_FALSE(setup);
  EXPECT_EQ(setup.error().kind, ErrorKind::kFailure);  // It may be plugged in later.
  EXPECT_THAT(setup.error().message,
              AllOf(HasSubstr("no board with board \"das1602/16\", serial \"77B0\""),
                    HasSubstr("there is /dev/comedi0: usb-1208fs (fake), serial \"01A2\""),
                    HasSubstr("/dev/comedi2: das1602/16 (fake), bus_path \"pci-0000:00:05.0\""),
                    Not(HasSubstr("\n"))));
}

TEST_F(BoardSearch, TwoBoardsThatFitAreNotGuessedBetween) {
  settings_.choice = {"usb-1208fs", "", ""};
  EXPECT_THAT(device(), AllOf(HasSubstr("/dev/comedi0"), HasSubstr("/dev/comedi1"), HasSubstr("add serial")));
}

// Serial number and place are read without opening it, its name is not.
TEST_F(BoardSearch, ABoardThatMayNotBeOpenedIsNamedAsThatWhichIsWanted) {
  world_.boards["/dev/comedi1"].open_error = EACCES;
  for (const drivers::BoardChoice& choice :
       {drivers::BoardChoice{"", "77B0", ""}, {"a board that may be it", "", ""}}) {
    settings_.choice = choice;
    const auto setup = agree();
    ASSERT_FALSE(setup);
    EXPECT_EQ(setup.error().kind, ErrorKind::kNoPermission);
    EXPECT_THAT(setup.error().message, HasSubstr("/dev/comedi1: permission denied"));
  }
  settings_.choice = {"", "01A2", ""};
  EXPECT_EQ(device(), "/dev/comedi0");
}

TEST_F(BoardSearch, AMissingPathNamesTheBoardsThatAreThere) {
  world_.boards.erase("/dev/comedi0");
  EXPECT_THAT(device(),
              AllOf(HasSubstr("/dev/comedi0: no such device"), HasSubstr("there is /dev/comedi1: usb-1208fs"),
                    HasSubstr("say its serial or bus_path")));
  world_.boards.clear();
  world_.boards["/dev/comedi7"] = {"", {}, ENODEV};  // Reserved for comedi_config.
  EXPECT_THAT(device(), Not(HasSubstr("there is")));
}

TEST_F(BoardSearch, ThePathOfAnotherBoardThanBeforeIsRefused) {
  daq::BoardInfo before;
  before.board_name = "das1602/16 (fake)";
  settings_.before = before;
  EXPECT_THAT(device(), AllOf(HasSubstr("another board has this device file now: usb-1208fs (fake)"),
                              HasSubstr("not das1602/16 (fake) as before"), HasSubstr("there is"),
                              HasSubstr("/dev/comedi2: das1602/16")));
}

// Moved to another port it is the same board; a board without a serial number may be any of its kind.
TEST_F(BoardSearch, TheBoardOfBeforeIsTakenWhereverItIsPluggedIn) {
  settings_.before = agree()->info;
  settings_.before->bus_path = "pci-0000:00:14.0-usb-0:9:1.0";
  EXPECT_EQ(device(), "/dev/comedi0");
  settings_.before->serial = "";
  EXPECT_EQ(device(), "/dev/comedi0");
  settings_.before->serial = "77B0";
  EXPECT_THAT(device(), HasSubstr("not serial \"77B0\" as before"));
}

// The choice says which board is meant: what acquired before does not count.
TEST_F(BoardSearch, AChoiceOutweighsWhatWasThereBefore) {
  settings_.before = agree()->info;
  settings_.choice = {"", "77B0", ""};
  EXPECT_EQ(device(), "/dev/comedi1");
}

TEST_F(BoardSearch, TheSurveySaysByWhichKeyTheBoardIsFound) {
  FakeComedi calls{world_, clock_};
  EXPECT_THAT(drivers::survey_board("/dev/comedi1", calls).configuration, HasSubstr("serial = \"77B0\" "));
  EXPECT_THAT(drivers::survey_board("/dev/comedi2", calls).configuration,
              HasSubstr("bus_path = \"pci-0000:00:05.0\" "));
}

/// A tree as the kernel's: subsystem links tell devices from other folders.
class PlaceInSysfs : public ::testing::Test {
 protected:
  PlaceInSysfs()
      : root_{std::filesystem::temp_directory_path() / fmt::format("stickslip-sysfs-{}", ::getpid())} {}
  ~PlaceInSysfs() override { std::filesystem::remove_all(root_); }

  void device(const std::string& path, const std::string& subsystem) {
    std::filesystem::create_directories(root_ / "devices" / path);
    if (!subsystem.empty())
      std::filesystem::create_symlink("/sys/bus/" + subsystem, root_ / "devices" / path / "subsystem");
  }

  void serial(const std::string& path, const std::string& text) {
    std::ofstream{root_ / "devices" / path / "serial"} << text << "\n";
  }

  drivers::BoardPlace place_below(const std::string& hardware) {
    const auto of_class = root_ / "devices" / hardware / "comedi" / "comedi3";
    std::filesystem::create_directories(of_class);
    std::filesystem::create_symlink("../..", of_class / "device");
    return drivers::place_in_sysfs(of_class, root_ / "devices");
  }

  std::filesystem::path root_;
};

// Buses, hubs and bridges on the way do not count: the kernel numbers buses as it finds them. udev's path_id
// does the same.
TEST_F(PlaceInSysfs, OfAUsbBoardIsItsPortAndTheSerialNumberOfTheDevice) {
  device("pci0000:00", "");
  device("pci0000:00/0000:00:1c.0", "pci");
  device("pci0000:00/0000:00:1c.0/0000:02:00.0", "pci");
  device("pci0000:00/0000:00:1c.0/0000:02:00.0/usb3", "usb");
  serial("pci0000:00/0000:00:1c.0/0000:02:00.0/usb3", "0000:02:00.0");  // Root hubs have one.
  const std::string board = "pci0000:00/0000:00:1c.0/0000:02:00.0/usb3/3-1/3-1.4";
  device("pci0000:00/0000:00:1c.0/0000:02:00.0/usb3/3-1", "usb");
  device(board, "usb");
  device(board + "/3-1.4:1.0", "usb");
  EXPECT_EQ(place_below(board + "/3-1.4:1.0"), (drivers::BoardPlace{"", "pci-0000:02:00.0-usb-0:1.4:1.0"}));
  std::filesystem::remove_all(root_ / "devices" / board / "3-1.4:1.0" / "comedi");
  serial(board, "01A2B3");
  EXPECT_EQ(place_below(board + "/3-1.4:1.0"),
            (drivers::BoardPlace{"01A2B3", "pci-0000:02:00.0-usb-0:1.4:1.0"}));
}

TEST_F(PlaceInSysfs, OfAPciBoardIsItsSlot) {
  device("pci0000:00/0000:00:05.0", "pci");
  EXPECT_EQ(place_below("pci0000:00/0000:00:05.0"), (drivers::BoardPlace{"", "pci-0000:00:05.0"}));
}

TEST_F(PlaceInSysfs, OfABoardWithoutABusIsItsPath) {
  device("virtual/comedi_test/comedi_testd", "comedi_test");
  EXPECT_EQ(place_below("virtual/comedi_test/comedi_testd"),
            (drivers::BoardPlace{"", "virtual/comedi_test/comedi_testd"}));
}

TEST_F(PlaceInSysfs, OfABoardAttachedByHandIsUnknown) {
  EXPECT_EQ(drivers::place_in_sysfs(root_ / "devices", root_), drivers::BoardPlace{});
  EXPECT_EQ(drivers::place_of("/dev/comedi-that-is-not-there"), drivers::BoardPlace{});
  EXPECT_EQ(drivers::place_of("/"), drivers::BoardPlace{});
}

}  // namespace
}  // namespace stickslip::test
