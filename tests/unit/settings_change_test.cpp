#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/base/settings.hpp"

namespace stickslip::base {
namespace {

constexpr const char* kText =
    "name = \"a\"  # a comment\n[paper]\nmu_s = 0.35\nmu_k = 0.3\n[effects.noise]\nsd = 0.1\n";

struct Change {
  const char* path;
  const char* value;  ///< Null: remove.
};

/// As a command would: the options are named --set and --without.
Result<Settings> changed(const std::vector<Change>& changes) {
  Result<Settings> settings = Settings::parse(kText, "x.toml");
  for (const auto& [path, value] : changes) {
    const Result<void> done = value != nullptr
                                  ? settings->set(path, value, fmt::format("--set {}={}", path, value))
                                  : settings->remove(path, fmt::format("--without {}", path));
    if (!done) return tl::unexpected(done.error());
  }
  return settings;
}

struct Read {
  std::string name;
  double mu_s = 0.0;
  double mu_k = 0.0;
  std::optional<double> noise;
  std::optional<double> speed_m_per_s;
  std::string text;
};

Result<Read> read(const std::vector<Change>& changes) {
  Result<Settings> settings = changed(changes);
  if (!settings) return tl::unexpected(settings.error());
  Read read;
  const Limits coefficient = Limits::between(0.0, 10.0);
  read.name = settings->text("name");
  Settings paper = settings->table("paper");
  read.mu_s = paper.quantity("mu_s", Dimension::kDimensionless, coefficient);
  read.mu_k = paper.quantity("mu_k", Dimension::kDimensionless, coefficient);
  if (read.mu_s < read.mu_k) paper.refuse("mu_s", "must not be below mu_k");
  Settings effects = settings->table("effects");
  read.noise = effects.table("noise").quantity_if_given("sd", Dimension::kDimensionless, coefficient);
  if (effects.has("pull")) {
    read.speed_m_per_s = effects.table("pull").quantity("speed", Dimension::kSpeed, Limits::above(0.0));
  }
  (void)effects.table("pull");
  read.text = settings->source_text();
  if (const Result<void> finished = settings->finish(); !finished) return tl::unexpected(finished.error());
  return read;
}

std::string refusal(const std::vector<Change>& changes) {
  const Result<Read> result = read(changes);
  if (result) return "";
  EXPECT_EQ(result.error().kind, ErrorKind::kUsage);
  return result.error().message;
}

TEST(SettingsChange, ReplacesAValueAndLeavesTheOthers) {
  const Result<Read> result = read({{"paper.mu_s", "0.34"}});
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->mu_s, 0.34);
  EXPECT_EQ(result->mu_k, 0.3);
  EXPECT_EQ(result->name, "a");
}

TEST(SettingsChange, TheLastOfTwoHolds) {
  EXPECT_EQ(read({{"paper.mu_s", "0.34"}, {"paper.mu_s", "0.33"}})->mu_s, 0.33);
}

TEST(SettingsChange, TextNeedsNoQuotes) {
  for (const char* value : {"12 in/min", "\"12 in/min\"", "'12 in/min'"}) {
    const Result<Read> result = read({{"effects.pull.speed", value}});
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(result->speed_m_per_s, 12 * 0.0254 / 60) << value;
  }
  EXPECT_EQ(read({{"name", "b # c"}})->name, "b # c");
  EXPECT_EQ(read({{"name", "S − K"}})->name, "S − K");
}

TEST(SettingsChange, RemovesATableThatCanThenBeMadeAnew) {
  EXPECT_EQ(read({{"effects.noise", nullptr}})->noise, std::nullopt);
  EXPECT_EQ(read({{"effects.noise", nullptr}, {"effects.noise.sd", "0.2"}})->noise, 0.2);
}

// The document as it is used must be what a record keeps of it.
TEST(SettingsChange, TheTextIsAFileThatGivesTheSameValues) {
  EXPECT_EQ(read({})->text, kText);
  const Result<Read> first =
      read({{"paper.mu_s", "0.3400000000000001"}, {"effects.pull.speed", "1 mm/s"}, {"name", "µ"}});
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ(first->text.substr(0, first->text.find('\n')),
            "# x.toml with --set paper.mu_s=0.3400000000000001 --set effects.pull.speed=1 mm/s --set name=µ");
  EXPECT_EQ(Settings::parse(first->text, "x")->text("name"), "µ");
  Result<Settings> again = Settings::parse(first->text, "again.toml");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->table("paper").quantity("mu_s", Dimension::kDimensionless, Limits::any()), first->mu_s);
  EXPECT_EQ(again->table("effects").table("pull").text("speed"), "1 mm/s");
}

TEST(SettingsChange, CannotSmuggleInAnotherKeyOrALine) {
  const std::string message = refusal({{"paper.mu_s", "0.34\nmu_k = 0.2"}});
  EXPECT_EQ(message.find("--set paper.mu_s=0.34\\x0amu_k = 0.2: "), 0U) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

struct Refused {
  std::vector<Change> changes;
  const char* message;
};

class SettingsChangeRefused : public testing::TestWithParam<Refused> {};

TEST_P(SettingsChangeRefused, WithOneLineThatNamesTheOption) {
  EXPECT_EQ(refusal(GetParam().changes), GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    Mistakes, SettingsChangeRefused,
    testing::Values(
        Refused{{{"paper.mu", "3"}},
                "--set paper.mu=3: paper.mu = 3: unknown key; did you mean mu_k? Known here: mu_k, mu_s"},
        Refused{{{"paper.mu_s", "11"}}, "--set paper.mu_s=11: paper.mu_s = 11: must be from 0 to 10"},
        Refused{{{"paper.mu_s", "nan"}}, "--set paper.mu_s=nan: paper.mu_s = nan: must be finite"},
        Refused{{{"paper.mu_s", ""}},
                "--set paper.mu_s=: paper.mu_s = \"\": does not begin with a decimal "
                "number; write a number and one of: no unit, %, ppm"},
        Refused{{{"paper.mu_s", "0.1"}}, "--set paper.mu_s=0.1: paper.mu_s = 0.1: must not be below mu_k"},
        // The fault shows in the file, the cause is the option.
        Refused{{{"paper.mu_k", "0.4"}},
                "x.toml:3: paper.mu_s = 0.35: must not be below mu_k (with --set paper.mu_k=0.4)"},
        Refused{{{"effects.nois.sd", "1"}},
                "--set effects.nois.sd=1: [effects.nois]: unknown table; did you mean noise? Known here: "
                "noise, pull"},
        Refused{{{"effects.pull", "{ speed = 5 }"}},
                "--set effects.pull={ speed = 5 }: effects.pull.speed = 5: a speed needs its unit, such "
                "as \"5 mm/min\" or \"5 m/s\""},
        Refused{{{"effects.pull", "{}"}},
                "--set effects.pull={}: effects.pull.speed is missing; it must be above 0 m/s, written as a "
                "string with its unit"},
        Refused{{{"effects", "3"}}, "--set effects=3: effects = 3: must be a table, written as [effects]"},
        Refused{{{"paper.mu_s.x", "1"}}, "--set paper.mu_s.x=1: paper.mu_s is no table"},
        Refused{{{"", "1"}}, "--set =1: needs a key, such as paper.mu_s"},
        Refused{{{"paper..mu_s", "1"}}, "--set paper..mu_s=1: needs a key, such as paper.mu_s"},
        Refused{{{"paper.", "1"}}, "--set paper.=1: needs a key, such as paper.mu_s"},
        Refused{{{"effects.nois", nullptr}},
                "--without effects.nois: effects.nois is not there; did you mean noise? Known here: noise"},
        Refused{{{"no.such", nullptr}}, "--without no.such: no.such is not there; known here: "},
        Refused{{{"", nullptr}}, "--without :  is not there; known here: "}));

TEST(SettingsChange, RefusesTextThatNoFileCanHold) {
  const std::string message = refusal({{"name", "\xff\xfe"}});
  EXPECT_NE(message.find(" is no text in UTF-8: write it"), std::string::npos) << message;
}

}  // namespace
}  // namespace stickslip::base
