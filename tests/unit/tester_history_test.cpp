#include "daemon/types/tester_history.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include "core/record/finaliser.hpp"
#include "daemon/charts/keeper.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::daemon {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using trend::Quantity;

std::optional<double> value(const HistoryEvent& event, Quantity quantity) {
  return std::get<TestFinished>(event.what).values.values[static_cast<std::size_t>(quantity)];
}

record::Record charted_record() {
  record::Record record = test::whole_record();
  record.header.board.scan_rate_granted_Hz = 350.0;
  record.header.start_realtime_ns = 1'000'000'000;
  record.header.process.characterisation.clear();
  record.header.self_check = daq::SelfCheck{};
  record.header.self_check->zero_N = 0.01;
  record.header.self_check->noise_N = 0.002;
  record.end->end_realtime_ns = 11'000'000'000;
  record.end->results.omega = analysis::Estimate::of(125.0);
  record.end->results.gamma_over_2omega = analysis::Estimate::of(0.022);
  record.end->results.spike_count = analysis::Estimate::of(7.0);
  record.end->results.scan_rate_measured = analysis::Estimate::of(350.035);
  return record;
}

TEST(TestEvent, TakesFromTheRecordWhatTheTestItselfMeasured) {
  record::Record record = charted_record();
  const auto event = test_event(record, "2026/11/a.h5");
  ASSERT_TRUE(event);
  EXPECT_EQ(value(*event, Quantity::kOmega), 125.0);
  EXPECT_EQ(value(*event, Quantity::kDamping), 0.022);
  EXPECT_EQ(value(*event, Quantity::kZero), 0.01);
  EXPECT_EQ(value(*event, Quantity::kNoise), 0.002);
  EXPECT_NEAR(*value(*event, Quantity::kSpikes), 7.0 / 3500.0, 1e-12);  // 10 s of 350 Hz.
  EXPECT_NEAR(*value(*event, Quantity::kRate), 1e-4, 1e-12);

  // With a characterisation, omega and gamma are mostly what was known beforehand.
  record.header.process.characterisation = "omega = 1";
  const auto characterised = test_event(record, "a.h5");
  EXPECT_FALSE(value(*characterised, Quantity::kOmega));
  EXPECT_FALSE(value(*characterised, Quantity::kDamping));
  record.header.self_check.reset();
  EXPECT_FALSE(value(*test_event(record, "a.h5"), Quantity::kZero));
  record.end.reset();
  EXPECT_FALSE(test_event(record, "a.h5"));
}

class TesterHistoryTest : public testing::Test {
 protected:
  static HistoryEvent test_of(int number, double noise_N) {
    TestFinished test{
        .uuid = "u" + std::to_string(number), .status = record::Status::kComplete, .values = {}};
    test.values.time = "t" + std::to_string(number);
    test.values.file = std::to_string(1000 + number) + ".h5";
    test.values.values[static_cast<std::size_t>(Quantity::kNoise)] = noise_N;
    return {test.values.time, test};
  }
  [[nodiscard]] std::int64_t noise_count(const TesterHistory& history) const {
    return history.charts(book_).state(Quantity::kNoise).chart.count();
  }

  test::TemporaryFolder temporary_;
  std::filesystem::path folder_ = temporary_.path();
  BatchBook book_;
};

TEST_F(TesterHistoryTest, GivesBackEachEventToTheLastBit) {
  const std::vector<HistoryEvent> events{
      test_event(charted_record(), "a\"b.h5").value(),
      {"t", ChartsRestarted{Quantity::kZero, true, "nothing \"found\"", "ada"}},
      {"t", ChartsRestarted{std::nullopt, false, "new cell", "ada"}},
      {"t", ReferenceNamed{"reference 7"}}};
  ASSERT_TRUE(TesterHistory{folder_}.append(events));
  TesterHistory history{folder_};
  EXPECT_THAT(history.read_on().value(), IsEmpty());
  EXPECT_EQ(history.events(), events);
  EXPECT_EQ(history.reference(), "reference 7");
}

// Each single byte of a line is changed: none is taken for what was written.
TEST_F(TesterHistoryTest, LeavesOutALineThatWasChangedAndTellsItsPlace) {
  const std::string line = line_of(test_of(1, 0.5));
  ASSERT_TRUE(history_event_of(line));
  for (std::size_t i = 0; i < line.size(); ++i) {
    std::string changed = line;
    changed[i] = static_cast<char>(changed[i] ^ 1);
    EXPECT_FALSE(history_event_of(changed)) << i;
  }
  ASSERT_TRUE(TesterHistory{folder_}.append({test_of(1, 0.5)}));
  std::ofstream{folder_ / kTesterHistory, std::ios::app} << R"({"at":"t","event":"test","noise_N":9})"
                                                         << '\n';
  ASSERT_TRUE(TesterHistory{folder_}.append({test_of(2, 0.5)}));
  TesterHistory history{folder_};
  const auto remarks = history.read_on().value();
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_THAT(remarks[0], HasSubstr("tester-history.jsonl: line 2: has no checksum; it is left out"));
  EXPECT_EQ(noise_count(history), 2);
}

TEST_F(TesterHistoryTest, CountsATestOnceAndNoneThatIsVoidOrIncomplete) {
  HistoryEvent incomplete = test_of(3, 0.5);
  std::get<TestFinished>(incomplete.what).status = record::Status::kInterrupted;
  ASSERT_TRUE(TesterHistory{folder_}.append({test_of(1, 0.5), test_of(1, 0.5), test_of(2, 0.5), incomplete}));
  TesterHistory history{folder_};
  EXPECT_THAT(history.read_on().value(), IsEmpty());
  EXPECT_EQ(noise_count(history), 2);
  book_.apply({"t", "ada", TestVoided{"1002.h5", "torn"}});
  EXPECT_EQ(noise_count(history), 1);
}

TEST_F(TesterHistoryTest, RestartsOneChartOrAll) {
  ASSERT_TRUE(TesterHistory{folder_}.append(
      {test_of(1, 0.5), {"t", ChartsRestarted{Quantity::kZero, false, "x", "ada"}}, test_of(2, 0.5)}));
  TesterHistory history{folder_};
  ASSERT_TRUE(history.read_on());
  EXPECT_EQ(noise_count(history), 2);
  ASSERT_TRUE(history.append({{"t", ChartsRestarted{std::nullopt, false, "x", "ada"}}}));
  ASSERT_TRUE(history.read_on());
  EXPECT_EQ(noise_count(history), 0);
}

TEST_F(TesterHistoryTest, ForgetsAllButTheLatestTests) {
  std::vector<HistoryEvent> events;
  for (std::size_t k = 0; k < TesterHistory::kRemembered + 5; ++k) {
    TestFinished test;
    test.uuid = fmt::format("{:08}-0000-4000-8000-000000000000", k);
    test.values.file = fmt::format("20261121T125252Z-{:05}.h5", k);
    events.push_back({"t", test});
  }
  TesterHistory history{folder_};
  ASSERT_TRUE(history.append(events));
  ASSERT_TRUE(history.read_on());
  EXPECT_THAT(history.events(), SizeIs(events.size()));
  history.forget();
  EXPECT_THAT(history.events(), IsEmpty());
  EXPECT_THAT(history.records(), SizeIs(TesterHistory::kRemembered));
  EXPECT_FALSE(history.has("00000004-0000-4000-8000-000000000000"));
  EXPECT_TRUE(history.has("00000005-0000-4000-8000-000000000000"));
}

/// A keeper with the alarms that it told.
class KeeperTest : public TesterHistoryTest {
 protected:
  void keep(const std::function<void(charts::Keeper&)>& work, const std::string& reference = {}) {
    charts::Keeper keeper{{.folder = folder_,
                           .reference = reference,
                           .alarmed = [this](const base::Finding& finding) { told_.push_back(finding.code); },
                           .troubled = [this](const std::string& why) { troubles_.push_back(why); },
                           .clock = &clock_}};
    keeper.open();
    work(keeper);
    keeper.settle();
    keeper.close();
    state_ = keeper.state();
  }
  void make_record(const std::string& name, const std::string& uuid) {
    record::Record record = charted_record();
    record.header.uuid = uuid;
    record.end->status = record::Status::kComplete;
    record.end->reasons.clear();
    ASSERT_TRUE(record::publish_record(record, folder_ / name));
  }
  [[nodiscard]] std::int64_t count(Quantity quantity) const {
    return state_.charts.at(static_cast<std::size_t>(quantity)).test_count;
  }

  test::ManualClock clock_;
  std::vector<std::string> told_;
  std::vector<std::string> troubles_;
  TrendState state_;
};

// A kill between the record and its line, or an upgrade from a version without a history.
TEST_F(KeeperTest, AddsAtTheStartTheRecordsThatTheHistoryLacksAndEachOnce) {
  make_record("20261121T125252Z-0001.h5", "00000000-0000-4000-8000-000000000001");
  make_record("20261121T125252Z-0002.h5", "00000000-0000-4000-8000-000000000002");
  keep([](charts::Keeper&) {});
  EXPECT_EQ(count(Quantity::kNoise), 2);
  make_record("20261121T125252Z-0003.h5", "00000000-0000-4000-8000-000000000003");
  keep([this](charts::Keeper& keeper) { keeper.record_published(folder_ / "20261121T125252Z-0003.h5"); });
  EXPECT_EQ(count(Quantity::kNoise), 3);
  // Records are removed; the history stays.
  std::filesystem::remove(folder_ / "20261121T125252Z-0001.h5");
  keep([](charts::Keeper&) {});
  EXPECT_EQ(count(Quantity::kNoise), 3);
  TesterHistory history{folder_};
  ASSERT_TRUE(history.read_on());
  EXPECT_THAT(history.events(), SizeIs(3));
}

TEST_F(KeeperTest, WritesDownTheReferencePaperWhenItsNameChanges) {
  keep([](charts::Keeper&) {}, "ref");
  keep([](charts::Keeper&) {}, "ref");
  EXPECT_EQ(state_.reference, "ref");
  TesterHistory history{folder_};
  ASSERT_TRUE(history.read_on());
  EXPECT_THAT(history.events(), SizeIs(1));
}

TEST_F(KeeperTest, TellsAStandingAlarmOnceForEachStart) {
  std::vector<HistoryEvent> events;
  for (int i = 0; i < 100; ++i) events.push_back(test_of(i, i % 2 == 0 ? 0.5 : 0.6));
  for (int i = 100; i < 112; ++i) events.push_back(test_of(i, 2.0));
  ASSERT_TRUE(TesterHistory{folder_}.append(events));
  make_record("20261121T125252Z-0001.h5", "00000000-0000-4000-8000-000000000001");
  keep([this](charts::Keeper& keeper) { keeper.record_published(folder_ / "20261121T125252Z-0001.h5"); });
  EXPECT_THAT(told_, testing::ElementsAre("trend-noise"));
  EXPECT_THAT(state_.findings, SizeIs(1));
  ASSERT_TRUE(
      TesterHistory{folder_}.append({{"t", ChartsRestarted{Quantity::kNoise, true, "mended", "ada"}}}));
  keep([](charts::Keeper&) {});
  EXPECT_THAT(state_.findings, IsEmpty());
}

TEST_F(KeeperTest, TellsTroubleWithTheHistoryOnceAndKeepsItInTheState) {
  std::ofstream{folder_ / kTesterHistory} << "what is this\n";
  make_record("20261121T125252Z-0001.h5", "00000000-0000-4000-8000-000000000001");
  keep([](charts::Keeper&) {});
  EXPECT_THAT(troubles_, testing::ElementsAre(HasSubstr("line 1: has no checksum")));
  EXPECT_EQ(state_.trouble, troubles_.front());
  EXPECT_EQ(count(Quantity::kNoise), 1);
}

// `stickslip trend --restart` and `stickslip void` beside the daemon: no test need follow.
TEST_F(KeeperTest, KnowsARestartAndAVoidingWhenItIsAsked) {
  ASSERT_TRUE(TesterHistory{folder_}.append({test_of(1, 0.5), test_of(2, 0.6), test_of(3, 0.7)}));
  keep([this](charts::Keeper& keeper) {
    const auto noise = [&keeper] {
      nlohmann::json told;
      keeper.ask([&told](const std::string& text) { told = nlohmann::json::parse(text); });
      keeper.settle();
      return told["charts"][static_cast<std::size_t>(Quantity::kNoise)];
    };
    EXPECT_THAT(noise()["points"]["value"], testing::ElementsAre(0.5, 0.6, 0.7));
    ASSERT_TRUE(BatchJournal{folder_}.append({"t", "ada", TestVoided{"1002.h5", "torn"}}));
    EXPECT_THAT(noise()["points"]["file"], testing::ElementsAre("1001.h5", "1003.h5"));
    ASSERT_TRUE(
        TesterHistory{folder_}.append({{"t", ChartsRestarted{Quantity::kNoise, false, "new cell", "ada"}}}));
    EXPECT_EQ(noise()["test_count"], 0);
    ASSERT_TRUE(TesterHistory{folder_}.append({test_of(4, 0.5)}));
    keeper.look();
    keeper.settle();
    EXPECT_EQ(keeper.state().charts.at(static_cast<std::size_t>(Quantity::kNoise)).test_count, 1);
  });
}

TEST_F(KeeperTest, ReadsAHistoryThatWasReplacedFromItsBeginning) {
  keep([this](charts::Keeper& keeper) {
    for (const char* const number : {"1", "2", "3"}) {
      make_record(fmt::format("20261121T125252Z-000{}.h5", number),
                  fmt::format("00000000-0000-4000-8000-00000000000{}", number));
      keeper.record_published(folder_ / fmt::format("20261121T125252Z-000{}.h5", number));
      keeper.settle();
      // Of the first two nothing is left.
      if (*number == '2') std::ofstream{folder_ / kTesterHistory} << "\n";
    }
    EXPECT_EQ(keeper.state().charts.at(static_cast<std::size_t>(Quantity::kNoise)).test_count, 0);
    make_record("20261121T125252Z-0004.h5", "00000000-0000-4000-8000-000000000004");
    keeper.record_published(folder_ / "20261121T125252Z-0004.h5");
  });
  EXPECT_THAT(troubles_, testing::ElementsAre(HasSubstr("is shorter than it was")));
  EXPECT_EQ(count(Quantity::kNoise), 2);
}

}  // namespace
}  // namespace stickslip::daemon
