// The index of a folder's records: it follows the files, survives kills, and takes what is typed as a text.

#include "io/catalogue/catalogue.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <ctime>

#include "core/base/descriptor.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/reader.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::catalogue {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

namespace fs = std::filesystem;

record::Record record_of(const std::string& sample, double static_coefficient = 0.35) {
  record::Record record = test::sample_record();
  record.header.sample.name = sample;
  record.end->results.mu_s = analysis::Estimate::of(static_coefficient, 0.001);
  return record;
}

/// \return true if the work, in a child, was ended by SIGKILL.
template <typename Work>
[[nodiscard]] bool is_killed_at(const Work& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    [&]() noexcept { work(); }();  // An exception must not go on with the tests of the parent.
    ::_exit(0);
  }
  int status = 0;
  return ::waitpid(child, &status, 0) == child && WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
}

/// Folders for records and for their index.
class Catalogue : public testing::Test {
 protected:
  [[nodiscard]] fs::path put(const std::string& name, const record::Record& record) const {
    const fs::path path = records() / name;
    fs::create_directories(path.parent_path());
    EXPECT_TRUE(record::publish_record(record, path));
    return path;
  }
  [[nodiscard]] Found find(const Query& query = {}, const Progress& progress = {}) const {
    const base::Result<Found> found = search_with(index(), records(), query, progress);
    EXPECT_TRUE(found) << found.error().message;
    return found.value_or(Found{});
  }
  [[nodiscard]] std::vector<std::string> samples(const Condition& condition) const {
    std::vector<std::string> names;
    for (const Entry& entry : find({.conditions = {condition}, .order = "sample"}).entries)
      names.push_back(entry.sample.name);
    return names;
  }
  [[nodiscard]] fs::path records() const { return folder_ / "records"; }
  [[nodiscard]] fs::path index() const { return folder_ / "index.sqlite"; }

 private:
  void SetUp() override { fs::create_directories(records()); }

  test::TemporaryFolder folder_;
};

TEST_F(Catalogue, HoldsWhatTheRecordHolds) {
  const record::Record record = record_of("liner 42");
  static_cast<void>(put("2026/11/pull.h5", record));
  const Found found = find();
  ASSERT_THAT(found.entries, SizeIs(1));
  const Entry& entry = found.entries.front();
  EXPECT_EQ(entry.file, "2026/11/pull.h5");
  EXPECT_EQ(entry.start_realtime_ns, record.header.start_realtime_ns);
  EXPECT_EQ(entry.sample, record.header.sample);
  EXPECT_EQ(entry.method, record.header.process.method);
  EXPECT_EQ(entry.results.regime, record.end->results.regime);
  EXPECT_EQ(entry.results.rung, record.end->results.rung);
  EXPECT_EQ(entry.results.findings, record.end->results.findings);
  std::vector<analysis::Estimate> expected;
  analysis::for_each_result(
      record.end->results, [&](const analysis::ResultName&, const analysis::Estimate& estimate) {
        expected.push_back({estimate.value, estimate.standard_error, estimate.systematic_uncertainty, {}});
      });
  std::size_t i = 0;
  analysis::for_each_result(entry.results,
                            [&](const analysis::ResultName& name, const analysis::Estimate& estimate) {
                              EXPECT_EQ(estimate, expected[i++]) << name.name;
                            });
}

TEST_F(Catalogue, ReadsOnlyWhatIsNewOrChangedAndDropsWhatIsGone) {
  const fs::path a = put("a.h5", record_of("A"));
  const fs::path b = put("b.h5", record_of("B"));
  EXPECT_EQ(find().followed.read_count, 2U);
  EXPECT_EQ(find().followed.read_count, 0U);
  fs::remove(a);
  fs::rename(put("new.h5", record_of("B, again")), b);
  static_cast<void>(put("c.h5", record_of("C")));
  const Found found = find();
  EXPECT_EQ(found.followed.read_count, 2U);
  EXPECT_EQ(found.followed.removed_count, 1U);
  EXPECT_THAT(samples(is_like(Text::kSample, {"*"})), ElementsAre("B, again", "C"));
}

TEST_F(Catalogue, ADamagedRecordIsNamedAndNotReadAnewUntilItChanges) {
  const fs::path path = put("a.h5", record_of("A"));
  fs::resize_file(path, fs::file_size(path) / 2);
  const Found found = find();
  EXPECT_THAT(found.entries, SizeIs(0));
  ASSERT_THAT(found.unread, SizeIs(1));
  EXPECT_EQ(found.unread.front().file, "a.h5");
  EXPECT_EQ(found.unread.front().state, State::kUnreadable);
  EXPECT_THAT(found.unread.front().why, HasSubstr("cut short or damaged"));
  const Found again = find();
  EXPECT_EQ(again.followed.read_count, 0U);
  EXPECT_THAT(again.unread, SizeIs(1));
  fs::rename(put("new.h5", record_of("A")), path);
  EXPECT_THAT(find().entries, SizeIs(1));
}

TEST_F(Catalogue, ARecordThatIsBeingWrittenIsLookedAtAgain) {
  const fs::path path = put("a.h5", record_of("A"));
  {
    const base::Descriptor writer{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
    ASSERT_EQ(::flock(writer.get(), LOCK_EX), 0);
    const Found found = find();
    ASSERT_THAT(found.unread, SizeIs(1));
    EXPECT_EQ(found.unread.front().state, State::kNotLooked);
  }
  const Found found = find();
  EXPECT_THAT(found.entries, SizeIs(1));
  EXPECT_THAT(found.unread, SizeIs(0));
}

TEST_F(Catalogue, ADamagedIndexIsMadeAnewWithANotice) {
  static_cast<void>(put("a.h5", record_of("A")));
  ASSERT_THAT(find().entries, SizeIs(1));
  const std::string whole = test::content_of(index());
  std::string torn = whole;
  std::fill(torn.begin() + 4096, torn.end(), 'x');
  for (const std::string& content :
       {std::string{"no database at all"}, torn, whole.substr(0, whole.size() / 2)}) {
    test::write_content(index(), content);
    const Found found = find();
    EXPECT_THAT(found.entries, SizeIs(1));
    EXPECT_THAT(found.notices, ElementsAre(HasSubstr("was damaged; it is made anew")));
    EXPECT_THAT(find().notices, SizeIs(0));
  }
}

TEST_F(Catalogue, AnIndexWithDamageInAValidFileIsMadeAnewWithANotice) {
  static_cast<void>(put("a.h5", record_of("A")));
  ASSERT_THAT(find().entries, SizeIs(1));
  for (const char* const damage :
       {"UPDATE record SET findings = '[{'", "UPDATE record SET findings = 'null'",
        "UPDATE record SET findings = '[{\"code\": 1}]'", "UPDATE record SET findings = NULL",
        "DROP TABLE record", "DROP TABLE record; CREATE TABLE record(id INTEGER PRIMARY KEY)",
        "DROP TABLE file"}) {
    Database{index().string()}.run(damage);
    const Found found = find();
    EXPECT_THAT(found.entries, SizeIs(1)) << damage;
    EXPECT_THAT(found.notices, ElementsAre(HasSubstr("was damaged; it is made anew"))) << damage;
    EXPECT_THAT(find().notices, SizeIs(0)) << damage;
  }
}

TEST_F(Catalogue, WithoutAPlaceForTheIndexASearchReadsAll) {
  static_cast<void>(put("a.h5", record_of("A")));
  fs::create_directories(index());  // No file can be made there.
  const Found found = find();
  EXPECT_THAT(found.entries, SizeIs(1));
  EXPECT_THAT(found.notices, ElementsAre(HasSubstr("no index is kept")));
}

TEST_F(Catalogue, ALockIsToldFromDamage) {
  Database first{index().string()};
  const Transaction transaction{first};
  Database second{index().string()};
  second.run("PRAGMA busy_timeout = 0");
  try {
    second.run("BEGIN IMMEDIATE");
    ADD_FAILURE() << "is not locked";
  } catch (const SqlError& error) {
    EXPECT_EQ(error.trouble(), Trouble::kLocked);
  }
}

TEST_F(Catalogue, AnIndexOfAnotherVersionIsEmptied) {
  static_cast<void>(put("a.h5", record_of("A")));
  ASSERT_THAT(find().entries, SizeIs(1));
  Database{index().string()}.run("PRAGMA user_version = 1");
  EXPECT_EQ(find().followed.read_count, 1U);
}

TEST_F(Catalogue, KilledWhileItReadsGoesOnAtTheLastCommit) {
  const fs::path first = put("0.h5", record_of("A"));
  constexpr int kFiles = 401;
  for (int i = 1; i < kFiles; ++i) fs::copy_file(first, records() / (std::to_string(i) + ".h5"));
  std::size_t left = kFiles;
  for (const std::size_t kill_at : {0U, 150U, 200U, 0U, 200U}) {
    ASSERT_TRUE(is_killed_at([&] {
      static_cast<void>(search_with(index(), records(), {}, [kill_at](std::size_t done, std::size_t) {
        if (done == kill_at) static_cast<void>(std::raise(SIGKILL));
      }));
    }));
    // 200 files between two commits.
    if (kill_at == 200) left -= std::min<std::size_t>(left, 200);
  }
  const Found found = find();
  EXPECT_EQ(found.followed.read_count, left);
  EXPECT_THAT(found.entries, SizeIs(kFiles));
  EXPECT_THAT(found.notices, SizeIs(0));
}

TEST_F(Catalogue, KilledWhileItWritesHoldsWhatItHeldBefore) {
  static_cast<void>(put("a.h5", record_of("A")));
  ASSERT_THAT(find().entries, SizeIs(1));
  for (const int written : {1, 500}) {
    ASSERT_TRUE(is_killed_at([&] {
      Index open{index().string()};
      Transaction transaction = open.begin();
      open.remove("a.h5");
      for (int i = 0; i < written; ++i) open.put(std::to_string(i), {}, record_of("never committed"));
      static_cast<void>(std::raise(SIGKILL));
    }));
    const Found found = find();
    EXPECT_EQ(found.followed.read_count + found.followed.removed_count, 0U);
    EXPECT_THAT(found.entries, SizeIs(1));
    EXPECT_THAT(found.notices, SizeIs(0));
  }
}

TEST_F(Catalogue, KilledWithHalfATransactionInTheFileHoldsWhatItHeldBefore) {
  static_cast<void>(put("a.h5", record_of("A")));
  ASSERT_THAT(find().entries, SizeIs(1));
  const std::string before = test::content_of(index());
  ASSERT_TRUE(is_killed_at([&] {
    Database open{index().string()};
    // One page of memory: the rest goes into the file before the commit.
    open.run(
        "PRAGMA cache_size = 1; BEGIN IMMEDIATE; DELETE FROM record; DELETE FROM file;"
        "INSERT INTO file(path, why) WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n LIMIT "
        "500)"
        " SELECT CAST(i AS BLOB), hex(randomblob(1000)) FROM n");
    static_cast<void>(std::raise(SIGKILL));
  }));
  EXPECT_NE(test::content_of(index()), before);
  const Found found = find();
  EXPECT_EQ(found.followed.read_count + found.followed.removed_count, 0U);
  EXPECT_THAT(found.entries, SizeIs(1));
  EXPECT_THAT(found.notices, SizeIs(0));
}

TEST_F(Catalogue, TwoProcessesAtOnceFindTheSame) {
  const fs::path first = put("0.h5", record_of("A"));
  for (int i = 1; i < 20; ++i) fs::copy_file(first, records() / (std::to_string(i) + ".h5"));
  const pid_t child = ::fork();
  if (child == 0) ::_exit(find().entries.size() == 20 ? 0 : 1);
  EXPECT_THAT(find().entries, SizeIs(20));
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST_F(Catalogue, WhatIsTypedIsATextAndNeverSql) {
  const std::string hostile = "'; DROP TABLE record; --";
  static_cast<void>(put("a.h5", record_of(hostile)));
  static_cast<void>(put("b.h5", record_of("100 % _cotton\\")));
  EXPECT_THAT(samples(is_like(Text::kSample, {hostile})), ElementsAre(hostile));
  EXPECT_THAT(samples(is_like(Text::kSample, {"100 % _cotton\\"})), ElementsAre("100 % _cotton\\"));
  EXPECT_THAT(samples(is_like(Text::kSample, {"%", "_*", "1__*"})), SizeIs(0));
  EXPECT_THAT(find().entries, SizeIs(2));
}

TEST_F(Catalogue, FindsByPatternsRangesRegimesAndFindings) {
  static_cast<void>(put("a.h5", record_of("Liner 1", 0.30)));
  record::Record other = record_of("bag 7", 0.40);
  other.header.process.method = "penner-1995 kinetic_cycles=10";
  other.end->results.regime = model::Regime::kStickSlip;
  other.end->results.findings.clear();
  static_cast<void>(put("b.h5", other));
  EXPECT_THAT(samples(is_like(Text::kSample, {"liner ?"})), ElementsAre("Liner 1"));
  EXPECT_THAT(samples(is_like(Text::kSample, {"liner", "bag*"})), ElementsAre("bag 7"));
  EXPECT_THAT(samples(is_like(Text::kMethod, {"penner-1995"})), ElementsAre("bag 7"));
  // Both ends belong to the range.
  EXPECT_THAT(samples(*in_range("S=0.30:0.40", "--where")), ElementsAre("Liner 1", "bag 7"));
  EXPECT_THAT(samples(*in_range("mu_s=0.31:", "--where")), ElementsAre("bag 7"));
  EXPECT_THAT(samples(*in_range("S=:0.39", "--where")), ElementsAre("Liner 1"));
  EXPECT_THAT(samples(*in_range("S=+0.31:+1", "--where")), ElementsAre("bag 7"));
  EXPECT_THAT(samples(*in_range("Q_threshold=:9", "--where")), SizeIs(0));  // It has no value.
  EXPECT_THAT(samples(*has_regime({"stick-slip"}, "--regime")), ElementsAre("bag 7"));
  EXPECT_THAT(samples(*has_finding({"pull-speed"}, "--finding")), ElementsAre("Liner 1"));
  EXPECT_THAT(samples(*has_finding({"none", "slack"}, "--finding")), ElementsAre("bag 7"));
  const Query last{.conditions = {}, .order = "mu_s", .reversed = true, .most = 1};
  EXPECT_EQ(find(last).entries.front().sample.name, "bag 7");
}

TEST_F(Catalogue, CountsWhatMeetsTheConditionsBeyondTheFirst) {
  for (const char* const name : {"a", "b", "c", "d"})
    static_cast<void>(put(std::string{name} + ".h5", record_of(name)));
  static_cast<void>(put("e.h5", record_of("e", 0.5)));
  const Query query{
      .conditions = {in_range("S=:0.4", "").value()}, .order = "sample", .reversed = true, .most = 1};
  const Found found = find(query);
  ASSERT_THAT(found.entries, SizeIs(1));
  EXPECT_EQ(found.entries[0].sample.name, "d");
  EXPECT_EQ(found.match_count, 4U);
  EXPECT_EQ(find({}).match_count, 5U);
}

TEST_F(Catalogue, FindsByFactsAsTextsAndAsRanges) {
  record::Record warm = record_of("warm");
  record::Record silent = record_of("silent");
  silent.header.sample.metadata.clear();
  warm.header.sample.metadata = {{"temperature", "77 degF"}, {"lot", "47 a%"}, {"room", "lab \"2\""}};
  static_cast<void>(put("a.h5", warm));
  record::Record cold = record_of("cold");
  cold.header.sample.metadata = {{"temperature", "20 degC"}, {"humidity", "dry"}};
  static_cast<void>(put("b.h5", cold));
  static_cast<void>(put("c.h5", silent));
  const auto by = [this](const std::string& fact) { return samples(*has_fact(fact, "--fact")); };
  EXPECT_THAT(by("lot=47*"), ElementsAre("warm"));
  EXPECT_THAT(by("lot=47 a%"), ElementsAre("warm"));
  EXPECT_THAT(by("lot=47%"), SizeIs(0));
  EXPECT_THAT(by("room=lab \"2\""), ElementsAre("warm"));
  EXPECT_THAT(by("temperature=20 *"), ElementsAre("cold"));
  // Whatever unit it was stated in; both ends belong to the range.
  EXPECT_THAT(by("temperature=24.9 degC:25.1 degC"), ElementsAre("warm"));
  EXPECT_THAT(by("temperature=:20 degC"), ElementsAre("cold"));
  EXPECT_THAT(by("humidity=0 %:100 %"), SizeIs(0));
  EXPECT_THAT(by("'); DROP TABLE record; --=x"), SizeIs(0));
  EXPECT_EQ(find().entries.front().sample.metadata, warm.header.sample.metadata);
  EXPECT_THAT(has_fact("lot", "--fact").error().message, HasSubstr("--fact: \"lot\" has no '='"));
  EXPECT_THAT(has_fact("temperature=20:25", "--fact").error().message,
              HasSubstr("a temperature needs its unit"));
}

TEST_F(Catalogue, AnAbsentTextComesLast) {
  for (const char* const sample : {"", "A", "B"})
    static_cast<void>(put(std::string{"of "} + sample + ".h5", record_of(sample)));
  for (const bool reversed : {false, true}) {
    const Found found = find({.conditions = {}, .order = "sample", .reversed = reversed});
    ASSERT_THAT(found.entries, SizeIs(3));
    EXPECT_EQ(found.entries.front().sample.name, reversed ? "B" : "A");
    EXPECT_EQ(found.entries.back().sample.name, "");
  }
}

// Traces that were imported without a date.
TEST_F(Catalogue, TheFirstOfEqualDatesAreThoseOfTheWholeList) {
  record::Record undated = record_of("A");
  undated.header.start_realtime_ns.reset();
  for (const char* const name : {"a.h5", "b.h5", "c.h5"}) static_cast<void>(put(name, undated));
  ASSERT_THAT(find().entries, SizeIs(3));
  fs::remove(records() / "a.h5");
  static_cast<void>(put("a.h5", undated));  // The index has it last now.
  for (const bool reversed : {false, true}) {
    const std::string first =
        find({.conditions = {}, .order = {}, .reversed = reversed}).entries.front().file;
    const Found one = find({.conditions = {}, .order = {}, .reversed = reversed, .most = 1});
    ASSERT_THAT(one.entries, SizeIs(1));
    EXPECT_EQ(one.entries.front().file, first);
    EXPECT_EQ(one.match_count, 3U);
  }
}

TEST_F(Catalogue, RefusesNamingTheValueAndWhatIsKnown) {
  EXPECT_THAT(in_range("Sx=1:2", "--where").error().message,
              HasSubstr("--where Sx=1:2: there is no result called \"Sx\""));
  for (const char* const wrong :
       {"S", "S=", "S=1", "S=:", "S=a:", "S=1:2:3", "S=nan:", "S=:inf", "S=+-1:", "S=++1:", "S=+:"})
    EXPECT_THAT(in_range(wrong, "--where").error().message, HasSubstr("must be RESULT=LOWEST:HIGHEST"))
        << wrong;
  EXPECT_THAT(has_regime({"stickslip"}, "--regime").error().message, HasSubstr("did you mean stick-slip?"));
  EXPECT_THAT(has_finding({"slak"}, "--finding").error().message, HasSubstr("did you mean slack?"));
  EXPECT_THAT(sort_column("id; --", "--sort").error().message, HasSubstr("--sort id; --: "));
}

TEST_F(Catalogue, APathNeedNotBeUtf8) {
  static_cast<void>(put("\xff\n.h5", record_of("A")));
  EXPECT_EQ(find().entries.front().file, "\xff\n.h5");
  EXPECT_EQ(find().followed.read_count, 0U);
}

TEST(MomentTest, ADayIsThatOfTheLocalClock) {
  ::setenv("TZ", "Europe/Berlin", 1);
  ::tzset();
  constexpr std::int64_t kHour_ns = 3'600'000'000'000;
  const auto of = [](const char* text) { return moment_from_text(text, "--from").value(); };
  EXPECT_EQ(of("2026-11-21").begin_ns, of("2026-11-20T23:00:00Z").begin_ns);
  EXPECT_EQ(of("2026-11-21").end_ns - of("2026-11-21").begin_ns, 24 * kHour_ns);
  EXPECT_EQ(of("2026-03-29").end_ns - of("2026-03-29").begin_ns, 23 * kHour_ns);  // Summer time begins.
  EXPECT_EQ(of("2026-11-21 12:53").end_ns - of("2026-11-21 12:53").begin_ns, 60'000'000'000);
  EXPECT_EQ(of("2026-11-21T12:53:02+01:00").begin_ns, 1'795'261'982'000'000'000);
  EXPECT_EQ(local_minute(1'795'261'982'000'000'000), "2026-11-21 12:53");
  for (const char* const wrong :
       {"2026-02-30", "2026-13-01", "21.11.2026", "2026-11-21T25:00", "yesterday", ""})
    EXPECT_THAT(moment_from_text(wrong, "--from").error().message, HasSubstr("write it as 2026-11-21"))
        << wrong;
  for (const char* const far : {"1699-12-31", "2201-01-01", "0000-01-01", "9999-12-31T23:59:59Z"})
    EXPECT_THAT(moment_from_text(far, "--from").error().message, HasSubstr("the year must be 1700 to 2200"))
        << far;
  EXPECT_LT(of("1700-01-01").begin_ns, of("1700-01-01").end_ns);
  EXPECT_LT(of("2200-12-31").begin_ns, of("2200-12-31").end_ns);
  ::unsetenv("TZ");
  ::tzset();
}

}  // namespace
}  // namespace stickslip::catalogue
