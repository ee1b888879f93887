#include "core/model/method.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "io/config.hpp"
#include "io/method_file.hpp"

#include "core/record/method_text.hpp"

namespace stickslip {
namespace {

using io::MethodFile;
using model::Method;

const std::filesystem::path kFolder = std::filesystem::path{STICKSLIP_SOURCE_DIR} / "config" / "methods";

const std::string kHead = "name = \"own\"\ndescription = \"of this laboratory\"\n";

TEST(MethodFile, EveryShippedOneIsGoodAndNamedLikeItsFile) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    const base::Result<MethodFile> file = io::load_method(entry.path());
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->method.name, entry.path().stem());
    EXPECT_LE(file->description.size(), 110U) << file->method.name;
    // What is after a standard says what to compare with it.
    const bool of_no_standard = file->method.name == "penner-1995" || file->method.name == "speed-ramp" ||
                                file->method.name == "slide-hold-slide";
    EXPECT_EQ(file->check.empty(), of_no_standard) << file->method.name;
    ++count;
  }
  EXPECT_EQ(count, 7);
}

TEST(MethodFile, DefaultMethodIsTheRuleOfTheShippedPaper) {
  const Method shipped = io::load_method(kFolder / "penner-1995.toml")->method;
  const Method plain;
  EXPECT_EQ(shipped.name, plain.name);
  EXPECT_EQ(shipped.static_slip, plain.static_slip);
  EXPECT_EQ(shipped.kinetic_cycles, plain.kinetic_cycles);
  EXPECT_EQ(shipped.kinetic_travel, plain.kinetic_travel);
}

TEST(MethodFile, GivesEachSettingInSiUnits) {
  const base::Result<MethodFile> file =
      io::parse_method(kHead +
                           "check = [\"a\", \"b\"]\n[static]\nslip = 3\n[kinetic]\ntravel_from = \"10 "
                           "mm\"\ntravel_to = \"6 cm\"\n"
                           "[sled]\nmass = \"200 g\"\nmass_tolerance = \"2 g\"\narea = \"40 cm^2\"\n"
                           "[test]\nspeed = \"120 mm/min\"\nreplicates = 4\n",
                       "m.toml");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->check.size(), 2U);
  Method expected;
  expected.name = "own";
  expected.static_slip = 3;
  expected.kinetic_travel = model::TravelWindow{0.01, 0.06};
  expected.sled_mass_kg = model::Nominal{0.2, 0.002};
  expected.sled_area_m2 = 0.004;
  expected.pull_speed_m_per_s = model::Nominal{0.002, {}};
  expected.replicates = 4;
  EXPECT_EQ(file->method, expected);
}

TEST(MethodFile, ARampIsACourseOfTheSpeed) {
  const base::Result<MethodFile> file = io::load_method(kFolder / "speed-ramp.toml");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_FALSE(file->method.pull_speed_m_per_s);
  ASSERT_TRUE(file->method.speed_course);
  const std::vector<model::SpeedPoint>& points = file->method.speed_course->points();
  ASSERT_EQ(points.size(), 2U);
  constexpr double kInchPerMinute_m_per_s = 0.0254 / 60.0;
  EXPECT_DOUBLE_EQ(points[0].speed_m_per_s, 4.0 * kInchPerMinute_m_per_s);
  EXPECT_EQ(points[1].at_s, 8.0);
  EXPECT_DOUBLE_EQ(points[1].speed_m_per_s, 24.0 * kInchPerMinute_m_per_s);
}

TEST(MethodText, ARampComesBackToTheLastBit) {
  Method ramp;
  ramp.speed_course = model::PullSpeed::make({{0.0, 0.1 / 3.0}, {8.0, 0.0101600001}});
  const base::Result<Method> back = record::method_from_text(record::method_text(ramp));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(*back, ramp);
}

struct Mistake {
  std::string text;
  const char* error;
};

class MethodFileRefuses : public testing::TestWithParam<Mistake> {};

TEST_P(MethodFileRefuses, WithOneLine) {
  const base::Result<MethodFile> file = io::parse_method(GetParam().text, "m.toml");
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().exit_status(), 2);
  EXPECT_EQ(file.error().message, GetParam().error);
}

INSTANTIATE_TEST_SUITE_P(
    Mistakes, MethodFileRefuses,
    testing::Values(
        Mistake{"name = \"own method\"\ndescription = \"x\"\n",
                "m.toml:1: name = \"own method\": must be of lower case letters, digits and hyphens"},
        Mistake{"name = \"own\"\n", "m.toml:1: description is missing; it must be a string"},
        Mistake{kHead + "[static]\nslip = 0", "m.toml:4: static.slip = 0: must be an integer from 1 to 1000"},
        Mistake{kHead + "[kinetic]\ncycles = 1001",
                "m.toml:4: kinetic.cycles = 1001: must be an integer from 1 to 1000"},
        Mistake{kHead + "[kinetic]\ncycles = 5\ntravel_to = \"60 mm\"",
                "m.toml:4: kinetic.cycles = 5: must not stand beside a travel window"},
        Mistake{kHead + "[kinetic]\ntravel_from = \"1 mm\"",
                "m.toml:3: kinetic.travel_to: is missing: a window has an end, such as \"60 mm\""},
        Mistake{kHead + "[kinetic]\ntravel_from = \"60 mm\"\ntravel_to = \"60 mm\"",
                "m.toml:5: kinetic.travel_to = \"60 mm\": must be above travel_from = 0.06 m"},
        Mistake{kHead + "[sled]\nmass_tolerance = \"2 g\"",
                "m.toml:4: sled.mass_tolerance = \"2 g\": needs mass"},
        Mistake{kHead + "[sled]\narea = \"40 cm\"",
                "m.toml:4: sled.area = \"40 cm\": has the unit \"cm\"; allowed: m^2, cm^2, mm^2, in^2"},
        Mistake{kHead + "[test]\nspeed = \"0 mm/min\"",
                "m.toml:4: test.speed = \"0 mm/min\": must be above 0 m/s and at most 10 m/s"},
        Mistake{kHead + "[test]\nreplicas = 3",
                "m.toml:4: test.replicas = 3: unknown key; did you mean replicates? Known here: replicates, "
                "speed, speed_ramp, speed_to, speed_tolerance"},
        Mistake{kHead + "[test]\nspeed = \"4 in/min\"\nspeed_to = \"24 in/min\"",
                "m.toml:5: test.speed_to = \"24 in/min\": needs speed_ramp, the time to get there"},
        Mistake{kHead + "[test]\nspeed_to = \"24 in/min\"\nspeed_ramp = \"8 s\"",
                "m.toml:4: test.speed_to = \"24 in/min\": needs speed, with which the ramp begins"}));

TEST(MethodText, ReadsBackToTheSameMethodForEveryShippedOne) {
  EXPECT_EQ(record::method_text({}), "penner-1995 kinetic_cycles=10");
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    const Method method = io::load_method(entry.path())->method;
    const std::string text = record::method_text(method);
    const base::Result<Method> read = record::method_from_text(text);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(*read, method) << text;
  }
  Method third;
  third.static_slip = 3;
  EXPECT_EQ(record::method_from_text(record::method_text(third)).value(), third);
}

TEST(MethodText, RefusesWhatIsNoMethod) {
  for (const char* text : {"penner-1995", "x kinetic_cycles=0", "x kinetic_cycles=3x", " kinetic_cycles=3",
                           "x kinetic_travel=0.06", "x kinetic_travel=0.06:0.01", "x kinetic_cycles=3 speed=",
                           "x kinetic_cycles=3 colour=4", "x kinetic_cycles=3 sled_mass=0.2~"}) {
    const base::Result<Method> read = record::method_from_text(text);
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.error().exit_status(), 2);
  }
}

TEST(Method, NamesWhatATestDidOtherwise) {
  const Method method = io::load_method(kFolder / "iso-8295.toml")->method;
  EXPECT_TRUE(model::departures(method, 0.2, 0.1 / 60.0).empty());
  EXPECT_TRUE(model::departures(method, 0.202, 0.09 / 60.0).empty());  // at the edges
  EXPECT_TRUE(model::departures(method, {}, {}).empty());
  const std::vector<std::string> lines = model::departures(method, 2.331, 0.00508);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0], "sled mass 2.331 kg, iso-8295 asks 0.2 ± 0.002 kg");
  EXPECT_EQ(lines[1], "pull speed 304.8 mm/min, iso-8295 asks 100 ± 10 mm/min");
  // The paper names a sled but no tolerance.
  EXPECT_TRUE(model::departures(io::load_method(kFolder / "penner-1995.toml")->method, 1.0, 1.0).empty());
}

base::Result<io::DaemonConfig> config_with(const std::string& method) {
  const base::Result<base::Settings> settings = base::Settings::parse(
      "[board]\ndriver = \"simulated\"\nsimulated.scenes = [\"a\"]\n[method]\n" + method, "x.toml");
  return io::read_config(*settings, kFolder.parent_path());
}

TEST(MethodOfTheDaemon, IsTheOneOfTheFile) {
  const base::Result<io::DaemonConfig> config = config_with("file = \"methods/iso-8295.toml\"\n");
  ASSERT_TRUE(config) << config.error().message;
  const Method method = io::load_method(kFolder / "iso-8295.toml")->method;
  EXPECT_EQ(config->method, method);
  EXPECT_EQ(config->board.simulated.method, method);  // The truth is read by the same rule.
}

TEST(MethodOfTheDaemon, RefusesAFileThatIsNotThereAndAKeyBesideIt) {
  const base::Result<io::DaemonConfig> absent = config_with("file = \"methods/none.toml\"\n");
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().exit_status(), 2);
  EXPECT_NE(absent.error().message.find("methods/none.toml"), std::string::npos) << absent.error().message;
  const base::Result<io::DaemonConfig> both =
      config_with("file = \"methods/iso-8295.toml\"\nkinetic_cycles = 3\n");
  ASSERT_FALSE(both);
  EXPECT_EQ(both.error().message, "x.toml:6: method.kinetic_cycles = 3: stands in the method's file");
}

}  // namespace
}  // namespace stickslip
