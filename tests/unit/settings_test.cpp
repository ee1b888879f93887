#include "core/base/settings.hpp"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <functional>

namespace stickslip::base {
namespace {

enum class Colour { kRed, kBlue };
constexpr std::array<std::pair<std::string_view, Colour>, 2> kColours{
    {{"red", Colour::kRed}, {"blue", Colour::kBlue}}};

Settings parsed(std::string_view text) {
  Result<Settings> settings = Settings::parse(text, "x.toml");
  EXPECT_TRUE(settings) << settings.error().message;
  return *settings;
}

TEST(Settings, GiveEachKindOfValue) {
  Settings settings = parsed(R"(
mass = "2331 g"
mu = 0.35
share = "5 %"
whole = 1
damped = true
count = 5
name = "paper"
colour = "blue"
list = ["a", "b"]
[drive]
speed = "12 in/min"
[[effect]]
kind = "noise"
[[effect]]
kind = "spikes"
)");
  EXPECT_EQ(settings.quantity("mass", Dimension::kMass, Limits::above(0.0)), 2.331);
  EXPECT_EQ(settings.quantity("mu", Dimension::kDimensionless, Limits::at_least(0.0)), 0.35);
  EXPECT_EQ(settings.quantity("share", Dimension::kDimensionless, Limits::between(0.0, 1.0)), 0.05);
  EXPECT_EQ(settings.quantity("whole", Dimension::kDimensionless, Limits::any()), 1.0);
  EXPECT_TRUE(settings.boolean("damped"));
  EXPECT_EQ(settings.integer("count", 1, 10), 5);
  EXPECT_EQ(settings.text("name"), "paper");
  EXPECT_EQ(settings.choice<Colour>("colour", kColours), Colour::kBlue);
  EXPECT_EQ(settings.texts("list"), (std::vector<std::string>{"a", "b"}));
  Settings drive = settings.table("drive");
  EXPECT_EQ(drive.quantity("speed", Dimension::kSpeed, Limits::any()), 12 * 0.0254 / 60);
  std::vector<std::string> kinds;
  for (Settings& effect : settings.tables("effect")) kinds.push_back(effect.text("kind"));
  EXPECT_EQ(kinds, (std::vector<std::string>{"noise", "spikes"}));
  EXPECT_TRUE(settings.finish());
  EXPECT_EQ(settings.known_keys(),
            (std::vector<std::string>{"colour", "count", "damped", "drive.speed", "effect[].kind", "list",
                                      "mass", "mu", "name", "share", "whole"}));
}

TEST(Settings, TakeTheFallbackWhereAKeyIsAbsent) {
  Settings settings = parsed("");
  EXPECT_EQ(settings.quantity("mass", Dimension::kMass, Limits::above(0.0), 2.0), 2.0);
  EXPECT_EQ(settings.quantity_if_given("speed", Dimension::kSpeed, Limits::any()), std::nullopt);
  EXPECT_TRUE(settings.boolean("damped", true));
  EXPECT_EQ(settings.integer("count", 1, 10, 7), 7);
  EXPECT_EQ(settings.text("name", "none"), "none");
  EXPECT_EQ(settings.choice<Colour>("colour", kColours, Colour::kBlue), Colour::kBlue);
  EXPECT_TRUE(settings.texts("list", std::vector<std::string>{}).empty());
  EXPECT_EQ(settings.table("drive").integer("gear", 1, 5, 3), 3);
  EXPECT_TRUE(settings.tables("effect").empty());
  EXPECT_TRUE(settings.finish());
}

struct Mistake {
  const char* text;
  std::function<void(Settings&)> ask;
  const char* error;
};

class SettingsRefuse : public testing::TestWithParam<Mistake> {};

TEST_P(SettingsRefuse, WithOneLineThatNamesPlaceValueAndRemedy) {
  Settings settings = parsed(GetParam().text);
  GetParam().ask(settings);
  const Result<void> finished = settings.finish();
  ASSERT_FALSE(finished);
  EXPECT_EQ(finished.error().kind, ErrorKind::kUsage);
  EXPECT_EQ(finished.error().message, GetParam().error);
}

const auto ask_mass = [](Settings& s) { (void)s.quantity("mass", Dimension::kMass, Limits::above(0.0)); };
const auto ask_mu = [](Settings& s) {
  (void)s.quantity("mu", Dimension::kDimensionless, Limits::between(0.0, 10.0));
};

INSTANTIATE_TEST_SUITE_P(
    Mistakes, SettingsRefuse,
    testing::Values(
        Mistake{"\nmass = \"-3 g\"", ask_mass, "x.toml:2: mass = \"-3 g\": must be above 0 kg"},
        Mistake{"mass = \"3\"", ask_mass,
                "x.toml:1: mass = \"3\": a mass needs its unit, such as \"3 g\" or \"3 kg\""},
        Mistake{"mass = \"3 V\"", ask_mass,
                "x.toml:1: mass = \"3 V\": has the unit \"V\"; allowed: kg, g, mg, lb"},
        Mistake{"mass = 3", ask_mass,
                "x.toml:1: mass = 3: a mass needs its unit, such as \"3 g\" or \"3 kg\""},
        Mistake{"mass = true", ask_mass,
                "x.toml:1: mass = true: must be a string holding a number and its unit"},
        Mistake{"", ask_mass,
                "x.toml:1: mass is missing; it must be above 0 kg, written as a string with its unit"},
        Mistake{"mu = nan", ask_mu, "x.toml:1: mu = nan: must be finite"},
        Mistake{"mu = inf", ask_mu, "x.toml:1: mu = inf: must be finite"},
        Mistake{"mu = 11", ask_mu, "x.toml:1: mu = 11: must be from 0 to 10"},
        Mistake{"mu = -0.1", ask_mu, "x.toml:1: mu = -0.1: must be from 0 to 10"},
        Mistake{"mu = []", ask_mu, "x.toml:1: mu = []: must be a number"},
        Mistake{"on = 1", [](Settings& s) { (void)s.boolean("on"); },
                "x.toml:1: on = 1: must be true or false"},
        Mistake{"n = 1.5", [](Settings& s) { (void)s.integer("n", 1, 9); },
                "x.toml:1: n = 1.5: must be an integer from 1 to 9"},
        Mistake{"n = 10", [](Settings& s) { (void)s.integer("n", 1, 9); },
                "x.toml:1: n = 10: must be an integer from 1 to 9"},
        Mistake{"t = 1", [](Settings& s) { (void)s.text("t"); }, "x.toml:1: t = 1: must be a string"},
        Mistake{"l = [\"a\", 1]", [](Settings& s) { (void)s.texts("l"); },
                "x.toml:1: l = [ 'a', 1 ]: must be a list of strings"},
        Mistake{"c = \"green\"", [](Settings& s) { (void)s.choice<Colour>("c", kColours); },
                "x.toml:1: c = \"green\": must be one of \"red\", \"blue\""},
        Mistake{"[a]\n", [](Settings& s) { (void)s.table("a").text("t"); },
                "x.toml:1: a.t is missing; it must be a string"},
        Mistake{"a = 1", [](Settings& s) { (void)s.table("a"); },
                "x.toml:1: a = 1: must be a table, written as [a]"},
        Mistake{"a = 1", [](Settings& s) { (void)s.tables("a"); },
                "x.toml:1: a = 1: must be an array of tables, written as [[a]]"},
        Mistake{"[a]\nmas = \"1 g\"",
                [](Settings& s) { (void)s.table("a").quantity("mass", Dimension::kMass, Limits::any()); },
                "x.toml:2: a.mas = \"1 g\": unknown key; did you mean mass? Known here: mass"},
        Mistake{"[b]\n", [](Settings& s) { (void)s.table("tester"); },
                "x.toml:1: [b]: unknown table; known here: tester"},
        Mistake{"s = 0.2\nk = 0.3",
                [](Settings& s) {
                  (void)s.quantity("s", Dimension::kDimensionless, Limits::any());
                  (void)s.quantity("k", Dimension::kDimensionless, Limits::any());
                  s.refuse("s", "must not be below k = 0.3");
                },
                "x.toml:1: s = 0.2: must not be below k = 0.3"}));

struct BadText {
  const char* text;
  const char* error_start;
};

class SettingsTextRefused : public testing::TestWithParam<BadText> {};

TEST_P(SettingsTextRefused, WithFileAndLine) {
  const Result<Settings> settings = Settings::parse(GetParam().text, "x.toml");
  ASSERT_FALSE(settings);
  EXPECT_EQ(settings.error().kind, ErrorKind::kUsage);
  EXPECT_EQ(settings.error().message.substr(0, std::string_view{GetParam().error_start}.size()),
            GetParam().error_start);
  EXPECT_EQ(settings.error().message.find('\n'), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Syntax, SettingsTextRefused,
                         testing::Values(BadText{"\n\na = ", "x.toml:3: "},
                                         BadText{"a = 1\na = 2", "x.toml:2: "},
                                         BadText{"[a]\n[a]", "x.toml:2: "},
                                         BadText{"a = \"\xff\"", "x.toml:1: "},
                                         BadText{"a = 12 in/min", "x.toml:1: "}));

TEST(Settings, WhichCannotBeReadAreRefused) {
  const Result<Settings> absent = Settings::load("/nonexistent/x.toml");
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().message, "/nonexistent/x.toml: there is no such file");
  EXPECT_EQ(absent.error().exit_status(), 2);

  const Result<Settings> folder = Settings::load(std::filesystem::temp_directory_path());
  ASSERT_FALSE(folder);
  EXPECT_NE(folder.error().message.find("is a folder"), std::string::npos);

  const Result<Settings> endless = Settings::load("/dev/zero");
  ASSERT_FALSE(endless);
  EXPECT_NE(endless.error().message.find("is a device, not a regular file"), std::string::npos);
}

// A wrong value is told before an unknown key, and that before a missing one: a misspelt key is
// the reason why the right one is missing.
TEST(Settings, TellTheMostTellingMistakeFirst) {
  Settings settings = parsed("mas = \"1 g\"");
  ask_mass(settings);
  EXPECT_NE(settings.finish().error().message.find("unknown key; did you mean mass?"), std::string::npos);

  Settings both = parsed("mas = \"1 g\"\nn = 0");
  (void)both.integer("n", 1, 2);
  EXPECT_NE(both.finish().error().message.find("n = 0"), std::string::npos);
}

TEST(Settings, ShowLongValuesShortAndOnOneLine) {
  Settings settings = parsed("t = \"\"\"" + std::string(1000, 'x') + "\n\"\"\"\nu = \"a\\nb\"");
  (void)settings.integer("t", 0, 1);
  const std::string message = settings.finish().error().message;
  EXPECT_LT(message.size(), 200U);
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace stickslip::base
