#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include "daemon/batch/leader.hpp"
#include "daemon/types/batch_journal.hpp"
#include "daemon/types/batch_json.hpp"
#include "daemon/types/voidings.hpp"
#include "tests/support/faulty_disk.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::daemon {
namespace {

using Json = nlohmann::ordered_json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

BatchPlan plan_of_text(const std::string& text) {
  const base::Result<BatchPlan> plan = batch_plan_of(Json::parse(text));
  EXPECT_TRUE(plan) << plan.error().message;
  return plan.value_or(BatchPlan{});
}

BatchEvent at_noon(decltype(BatchEvent::what) what) {
  return {"2026-11-22T12:00:00.000000000+00:00", "ada", std::move(what)};
}

TEST(BatchPlan, IsMadeSpeedBySpeedSheetBySheetSlideBySlide) {
  const BatchPlan plan = plan_of_text(
      R"({"name": "liner", "pull_speeds": ["6 in/min", 0.00508], "replicates": 2, "slides": 2})");
  ASSERT_EQ(plan.pull_speeds_m_per_s.size(), 2U);
  const double slow = plan.pull_speeds_m_per_s[0];
  const double fast = plan.pull_speeds_m_per_s[1];
  EXPECT_DOUBLE_EQ(slow, 0.00254);
  EXPECT_THAT(steps(plan), ElementsAre(BatchStep{slow, 1, 1}, BatchStep{slow, 1, 2}, BatchStep{slow, 2, 1},
                                       BatchStep{slow, 2, 2}, BatchStep{fast, 1, 1}, BatchStep{fast, 1, 2},
                                       BatchStep{fast, 2, 1}, BatchStep{fast, 2, 2}));
  EXPECT_THAT(steps(plan_of_text(R"({"name": "liner"})")), ElementsAre(BatchStep{std::nullopt, 1, 1}));
}

TEST(BatchPlan, TakesSpeedAndNumberOfItsMethodWhereNobodySaysOtherwise) {
  const BatchPlan plan = plan_of_text(R"({"name": "liner", "method": "iso-8295"})");
  EXPECT_THAT(plan.method, testing::StartsWith("iso-8295 "));
  EXPECT_EQ(plan.pull_speeds_m_per_s.size(), 1U);
  EXPECT_GT(plan.replicates, 1);
  const BatchPlan own =
      plan_of_text(R"({"name": "liner", "method": "iso-8295", "pull_speeds": [0.01], "replicates": 1})");
  EXPECT_THAT(own.pull_speeds_m_per_s, ElementsAre(0.01));
  EXPECT_EQ(own.replicates, 1);
}

TEST(BatchPlan, GoesThroughJsonAndBack) {
  const BatchPlan plan = plan_of_text(
      R"({"name": "liner 42", "grade": "kraft", "direction": "MD", "side": "wire", "operator": "Ada",
          "method": "penner-1995 kinetic_cycles=7", "pull_speeds": [0.00254], "replicates": 3, "slides": 2,
          "limits": {"mu_k": {"lowest": 0.2}, "delta_mu": {"lowest": 0.01, "highest": 0.1}}})");
  const base::Result<BatchPlan> back = batch_plan_of(batch_plan_json(plan));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(*back, plan);
}

TEST(BatchPlan, RefusesWhatItCannotLeadThroughAndSaysWhy) {
  for (const auto& [text, why] : std::initializer_list<std::pair<const char*, const char*>>{
           {R"({})", "name: is missing"},
           {R"({"name": 1})", "name: must be text"},
           {R"({"name": "x", "nam": 1})", "there is no such key"},
           {R"({"name": "x", "replicates": 0})", "replicates: must be a whole number from 1 to 10000"},
           {R"({"name": "x", "slides": 1.5})", "slides: must be a whole number"},
           {R"({"name": "x", "replicates": 10000, "slides": 2})", "more than 10000 tests"},
           {R"({"name": "x", "pull_speeds": "12 in/min"})", "must be a list"},
           {R"({"name": "x", "pull_speeds": [0]})", "must be above 0"},
           {R"({"name": "x", "pull_speeds": [0.01, "10 mm/s"]})", "stands there twice"},
           {R"({"name": "x", "method": "no-such"})", "method: "},
           {R"({"name": "x", "limits": {"mu": {}}})", "no result called \"mu\""},
           {R"({"name": "x", "limits": {"mu_k": {"low": 1}}})", "no \"low\""},
           {R"({"name": "x", "limits": {"mu_k": {"lowest": 2, "highest": 1}}})",
            "lowest 2 is above highest 1"},
       }) {
    const base::Result<BatchPlan> plan = batch_plan_of(Json::parse(text));
    ASSERT_FALSE(plan) << text;
    EXPECT_EQ(plan.error().kind, base::ErrorKind::kUsage);
    EXPECT_THAT(plan.error().message, HasSubstr(why)) << text;
  }
}

TEST(BatchPlan, TakesQuantitiesWithTheirUnit) {
  Warnings warnings;
  const auto plan = batch_plan_of(Json::parse(R"({"name": "x", "pull_speeds": ["10 mm/s", "12 in/min"],
                      "limits": {"period_median": {"lowest": "500 ms", "highest": "2 s"}, "mu_k": {"highest": 0.4}}})"),
                                  &warnings);
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_THAT(plan->pull_speeds_m_per_s, ElementsAre(0.01, 12 * 0.0254 / 60));
  EXPECT_EQ(plan->limits.at("period_median"), (ResultLimits{0.5, 2.0}));
  EXPECT_THAT(warnings, IsEmpty());
  const auto numbers =
      batch_plan_of(Json::parse(R"({"name": "x", "pull_speeds_m_per_s": [0.01]})"), &warnings);
  EXPECT_THAT(numbers.value().pull_speeds_m_per_s, ElementsAre(0.01));
  EXPECT_THAT(warnings, IsEmpty());
}

TEST(BatchPlan, WarnsOfNumbersWithoutAUnit) {
  Warnings warnings;
  const auto plan = batch_plan_of(
      Json::parse(R"({"name": "x", "pull_speeds": [0.01], "limits": {"period_median": {"highest": 2}}})"),
      &warnings);
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_THAT(warnings,
              ElementsAre(HasSubstr("pull_speeds: \"0.01\": a speed needs its unit"),
                          HasSubstr("limits: period_median, highest: \"2\": a time needs its unit")));
}

TEST(BatchBook, CountsATestAtTheSpeedOfTheBenchWhereItPlansNone) {
  BatchBook book;
  book.apply(at_noon(BatchBegun{"b", plan_of_text(R"({"name": "liner", "slides": 2})")}));
  book.apply(at_noon(TestRecorded{"b", {"a.h5", {0.00508, 1, 1}}}));
  EXPECT_EQ(book.next_step(*book.current(), {}), (BatchStep{std::nullopt, 1, 2}));
}

TEST(ResultLimits, HoldTheirEnds) {
  const ResultLimits limits{0.2, 0.4};
  EXPECT_TRUE(limits.holds(0.2) && limits.holds(0.4));
  EXPECT_FALSE(limits.holds(0.19) || limits.holds(0.41));
  EXPECT_TRUE((ResultLimits{std::nullopt, 0.4}.holds(-1.0)));
}

class BatchJournalTest : public testing::Test {
 protected:
  test::TemporaryFolder temporary_;
  std::filesystem::path folder_ = temporary_.path();
};

TEST_F(BatchJournalTest, GivesBackWhatWasAppendedByWhomeverAlsoInPieces) {
  BatchJournal daemon{folder_};
  BatchBook book;
  EXPECT_THAT(daemon.read_on(book).value(), IsEmpty());  // No file yet.
  const BatchPlan plan = plan_of_text(
      R"({"name": "liner", "replicates": 2, "pull_speeds": [0.00508], "limits": {"mu_k": {"highest": 0.4}}})");
  ASSERT_TRUE(daemon.append(at_noon(BatchBegun{"b", plan})));
  ASSERT_TRUE(daemon.append(at_noon(TestRecorded{"b", {"2026/11/a.h5", {0.00508, 1, 1}}})));
  EXPECT_THAT(daemon.read_on(book).value(), IsEmpty());
  ASSERT_NE(book.current(), nullptr);
  EXPECT_EQ(book.current()->plan, plan);
  EXPECT_EQ(book.current()->who, "ada");
  EXPECT_EQ(book.current()->tests.at(0).step, (BatchStep{0.00508, 1, 1}));
  const BatchJournal by_hand{folder_};
  ASSERT_TRUE(by_hand.append(at_noon(TestVoided{"2026/11/a.h5", "paper torn"})));
  EXPECT_THAT(daemon.read_on(book).value(), IsEmpty());
  EXPECT_EQ(book.voided("2026/11/a.h5")->reason, "paper torn");
  ASSERT_TRUE(by_hand.append(at_noon(TestRestored{"2026/11/a.h5"})));
  ASSERT_TRUE(by_hand.append(at_noon(BatchEnded{"b"})));
  EXPECT_THAT(daemon.read_on(book).value(), IsEmpty());
  EXPECT_EQ(book.voided("2026/11/a.h5"), nullptr);
  EXPECT_EQ(book.current(), nullptr);
  EXPECT_EQ(book.find("liner"), book.find("b"));
}

TEST_F(BatchJournalTest, ALineTornByAPowerCutSpoilsNoOther) {
  const BatchJournal journal{folder_};
  ASSERT_TRUE(journal.append(at_noon(TestVoided{"a.h5", "paper torn"})));
  ASSERT_TRUE(journal.append(at_noon(TestVoided{"b.h5", "sled askew"})));
  // Its end may be missing: the next line brings it.
  const std::uintmax_t first = line_of(at_noon(TestVoided{"a.h5", "paper torn"})).size();
  const std::uintmax_t whole = std::filesystem::file_size(journal.path());
  for (std::uintmax_t size = 0; size <= whole; ++size) {
    // Cut at each byte; then somebody writes on.
    const auto cut = folder_ / "cut";
    std::filesystem::create_directories(cut);
    std::filesystem::copy_file(journal.path(), cut / kBatchJournal,
                               std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(cut / kBatchJournal, size);
    BatchJournal after{cut};
    BatchBook before_writing;
    EXPECT_THAT(after.read_on(before_writing).value(), IsEmpty())
        << "half a line is not yet one, size " << size;
    ASSERT_TRUE(after.append(at_noon(TestVoided{"c.h5", "dust"})));
    BatchBook book;
    BatchJournal again{cut};
    const auto remarks = again.read_on(book).value();
    EXPECT_LE(remarks.size(), 1U);
    EXPECT_NE(book.voided("c.h5"), nullptr) << size;
    EXPECT_EQ(book.voided("a.h5") != nullptr, size >= first) << size;
    EXPECT_EQ(book.voided("b.h5") != nullptr, size >= whole - 1) << size;
  }
}

TEST_F(BatchJournalTest, ADiskThatRefusesIsToldAndWrittenToAgainLater) {
  test::FaultyDisk disk;
  const BatchJournal journal{folder_, disk};
  ASSERT_TRUE(journal.append(at_noon(TestVoided{"a.h5", "torn"})));
  const int calls = 3;  // open, write, fdatasync
  for (int refused = 0; refused < calls; ++refused) {
    disk.refuse(refused, 2, ENOSPC);  // A write is refused after half of its bytes.
    const auto written = journal.append(at_noon(TestVoided{"b.h5", "torn"}));
    ASSERT_FALSE(written) << refused;
    EXPECT_THAT(written.error().message,
                testing::AllOf(HasSubstr("batches.jsonl: cannot be written"), HasSubstr("No space left")));
  }
  disk.works_again();
  ASSERT_TRUE(journal.append(at_noon(TestVoided{"c.h5", "torn"})));
  BatchBook book;
  ASSERT_TRUE(BatchJournal{folder_}.read_on(book));
  EXPECT_NE(book.voided("a.h5"), nullptr);
  EXPECT_NE(book.voided("c.h5"), nullptr);
}

TEST_F(BatchJournalTest, LinesThatMeanNothingAreToldWithTheirPlaceAndPassedOver) {
  BatchJournal journal{folder_};
  std::ofstream{journal.path()} << R"(what is this
{"event": "paused", "at": "t", "by": "x"}
{"event": "voided", "at": "t", "by": "x", "record": "a.h5"}

{"event": "voided", "at": "t", "by": "x", "record": "a.h5", "reason": "torn", "and": "more"}
)";
  BatchBook book;
  const auto remarks = journal.read_on(book).value();
  ASSERT_EQ(remarks.size(), 3U);
  EXPECT_THAT(remarks[0], HasSubstr("batches.jsonl: line 1: is no JSON object"));
  EXPECT_THAT(remarks[1], HasSubstr("line 2: \"paused\" is no event this program knows"));
  EXPECT_THAT(remarks[2], HasSubstr("line 3: \"reason\" is missing"));
  EXPECT_EQ(book.voided("a.h5")->reason, "torn");
}

TEST_F(BatchJournalTest, IsFoundFromDatedFolders) {
  const auto record = folder_ / "2026" / "11" / "a.h5";
  std::filesystem::create_directories(record.parent_path());
  std::ofstream{record} << "x";
  EXPECT_EQ(journal_folder_of(record), std::nullopt);
  ASSERT_TRUE(BatchJournal{folder_}.append(at_noon(TestVoided{"2026/11/a.h5", "torn"})));
  ASSERT_TRUE(journal_folder_of(record));
  EXPECT_EQ(name_in_journal(*journal_folder_of(record), record), "2026/11/a.h5");
}

// By a link, under another spelling of the folder, and after it was moved away.
TEST_F(BatchJournalTest, AVoidRecordIsVoidByAnyPath) {
  const auto place = folder_ / "2026" / "11";
  std::filesystem::create_directories(place);
  std::ofstream{place / "a.h5"} << "x";
  std::filesystem::create_symlink(place / "a.h5", folder_ / "link.h5");
  ASSERT_TRUE(BatchJournal{folder_}.append(at_noon(TestVoided{"2026/11/a.h5", "torn"})));
  ASSERT_TRUE(BatchJournal{folder_}.append(at_noon(TestVoided{"gone.h5", "lost"})));
  Voidings voidings;
  for (const auto& record :
       {place / "a.h5", folder_ / "link.h5", place / ".." / "11" / "a.h5", folder_ / "gone.h5"}) {
    const auto voided = voidings.of(record);
    ASSERT_TRUE(voided);
    EXPECT_TRUE(voided->has_value()) << record;
  }
  EXPECT_FALSE(voidings.of(place / "b.h5").value());
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(place);
  EXPECT_TRUE(Voidings{}.of("a.h5").value());
  std::filesystem::current_path(before);
}

/// A leader after a restart, and a program that says of every record that it is of one batch.
class BatchLeaderTest : public BatchJournalTest {
 protected:
  static constexpr const char* kBefore = "20231114T221200Z-0001.h5";  // The clock stands at 22:13:20.
  static constexpr const char* kAfter = "20231114T221300Z-0002.h5";

  /// The records that a batch of that name has after open().
  [[nodiscard]] std::vector<std::string> found(const std::string& batch) {
    const auto program = temporary_ / "program";
    test::write_content(program, "#!/bin/sh\necho '{\"batch\": \"" + batch + "\"}'\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    EXPECT_TRUE(
        BatchJournal{folder_}.append(at_noon(BatchBegun{batch, plan_of_text(R"({"name": "liner"})")})));
    for (const char* record : {kBefore, kAfter}) test::write_content(folder_ / record, "");
    batch::BatchLeader leader{
        {folder_, program.string(), [] { return Plan{}; }, [](const Plan&) {}, {}, {}, &clock_}};
    leader.open();
    std::vector<std::string> records;
    const Batch* const current = leader.book().current();
    for (const BatchTest& one : current != nullptr ? current->tests : std::vector<BatchTest>{})
      records.push_back(one.record);
    return records;
  }

  test::ManualClock clock_;
};

// Records that the journal lacks are looked for behind the batch: those before it are not even read.
TEST_F(BatchLeaderTest, FindsTheRecordsThatAStopKeptFromTheJournal) {
  EXPECT_THAT(found("20231114T221230Z"), ElementsAre(kAfter));
}

// A test that runs is not due, and neither is one whose record is being written.
TEST_F(BatchLeaderTest, TellsTheStepOfATestUntilItsRecordIsThere) {
  EXPECT_TRUE(BatchJournal{folder_}.append(
      at_noon(BatchBegun{"20231114T221230Z", plan_of_text(R"({"name": "liner", "replicates": 2})")})));
  batch::BatchLeader leader{
      {folder_, "/bin/false", [] { return Plan{}; }, [](const Plan&) {}, {}, {}, &clock_}};
  leader.open();
  EXPECT_TRUE(leader.progress().value().under_way.empty());
  leader.test_began(7);
  const BatchProgress progress = leader.progress().value();
  ASSERT_EQ(progress.under_way.size(), 1U);
  EXPECT_EQ(progress.under_way[0].test, 7);
  EXPECT_EQ(progress.under_way[0].step.replicate, 1);
  ASSERT_TRUE(progress.next);
  EXPECT_EQ(progress.next->replicate, 2);
  leader.record_failed(7);
  EXPECT_TRUE(leader.progress().value().under_way.empty());
}

// Its name says no more than that the clock was wrong then: the records themselves say whose they are.
TEST_F(BatchLeaderTest, FindsThoseOfABatchThatBeganWhileTheClockWasAhead) {
  EXPECT_THAT(found("20361122T100000Z"), ElementsAre(kBefore, kAfter));
}

}  // namespace
}  // namespace stickslip::daemon
