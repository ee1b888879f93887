#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "cli/doctor/checks.hpp"

#include "core/pipeline/bench_state.hpp"
#include "daemon/types/batch_journal.hpp"
#include "daemon/types/tester_history.hpp"
#include "tests/support/closed_folder.hpp"
#include "tests/support/lacking_disk.hpp"

namespace stickslip::doctor {
namespace {

namespace fs = std::filesystem;
using Verdict = Finding::Verdict;

/// All is well, but for what a test changes.
class Doctor : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path{testing::TempDir()} /
              (std::string{"doctor-"} + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_ / "records");
    std::ofstream{folder_ / "d.toml"}
        << "[board]\ndriver = \"simulated\"\nsimulated.scenes = [\"" STICKSLIP_SOURCE_DIR
           "/config/scenes/stick-slip-at-12-in-per-min.toml\"]\n[record]\nfolder = \""
        << (folder_ / "records").string() << "\"\n[control]\nsocket = \"" << (folder_ / "c.sock").string()
        << "\"\n";
    world_ = this_world(*clock_);
    world_.ask_status = [this](const fs::path&) -> base::Result<daemon::HttpReply> {
      if (status_.empty()) return base::failure("nobody answers");
      return daemon::HttpReply{200, status_, {}};
    };
    world_.clock_is_synchronised = [] { return true; };
    world_.realtime_priority = [] { return 99; };
    world_.lockable_size = [] { return std::nullopt; };
    world_.room = [](const fs::path&) { return std::int64_t{1} << 40; };
    world_.probe = [this](const fs::path& folder) { return record::probe_folder(folder, disk_); };
  }
  void TearDown() override { fs::remove_all(folder_); }

  Finding find(const std::string& check) {
    for (const Finding& finding : examine(folder_ / "d.toml", world_)) {
      if (finding.check == check) return finding;
    }
    return {check, Verdict::kUnknown, "absent", ""};
  }

  fs::path folder_;
  std::unique_ptr<base::Clock> clock_ = base::make_system_clock();
  DoctorWorld world_;
  std::string status_;
  test::LackingDisk disk_;
};

TEST_F(Doctor, ClockThatNobodySets) {
  EXPECT_EQ(find("clock").verdict, Verdict::kGood);
  world_.clock_is_synchronised = [] { return false; };
  EXPECT_EQ(find("clock").verdict, Verdict::kWarning);
}

// At 350 scans/s of 29 bytes and 9000 bytes of other entries a second: 10 min are 11.5 MB, 8 h are 552 MB.
TEST_F(Doctor, RoomOnTheDisk) {
  for (const auto& [room, verdict] :
       {std::pair{std::int64_t{11'400'000}, Verdict::kBad},
        std::pair{std::int64_t{11'600'000}, Verdict::kWarning},
        std::pair{std::int64_t{551'000'000}, Verdict::kWarning},
        std::pair{std::int64_t{553'000'000}, Verdict::kGood}, std::pair{std::int64_t{-1}, Verdict::kBad}}) {
    world_.room = [room = room](const fs::path&) { return room; };
    EXPECT_EQ(find("disk").verdict, verdict) << room;
  }
}

TEST_F(Doctor, BoardThatSomebodyElseHas) {
  world_.open_board = [](const drivers::BoardConfig&, base::Clock&) -> base::Result<drivers::OpenedBoard> {
    return tl::unexpected(base::Error{base::ErrorKind::kBusy, "in use"});
  };
  EXPECT_EQ(find("board").verdict, Verdict::kBad);
  // The daemon itself has it: then nobody else needs it, and it is not opened.
  status_ = R"({"state": "acquiring", "detail": "acquiring", "board": {"name": "b", "driver": "comedi"}})";
  EXPECT_EQ(find("board").verdict, Verdict::kGood);
}

TEST_F(Doctor, WhatTheRunningDaemonSaysOfItself) {
  status_ = R"({"state": "board missing", "detail": "board missing: it went away"})";
  EXPECT_EQ(find("daemon").verdict, Verdict::kBad);
  EXPECT_THAT(find("daemon").what, testing::HasSubstr("it went away"));
  status_ = R"({"state": "acquiring", "version": "0.0.1", "lost_scan_count": 12,
    "scheduling": "SCHED_OTHER (SCHED_FIFO 50 refused: Operation not permitted), memory locked",
    "board": {"scan_rate_granted": 350}, "scan_rate_measured": {"value": 360}})";
  EXPECT_THAT(find("daemon").what, testing::HasSubstr("version 0.0.1 runs"));
  EXPECT_EQ(find("scans").verdict, Verdict::kWarning);
  EXPECT_EQ(find("realtime").verdict, Verdict::kWarning);
  EXPECT_EQ(find("rate").verdict, Verdict::kWarning);
  status_ = "no JSON";
  EXPECT_EQ(find("daemon").verdict, Verdict::kBad);
}

TEST_F(Doctor, ABenchThatStaysInItsState) {
  status_ = R"({"state": "acquiring", "bench": "armed", "bench_trouble": null})";
  EXPECT_EQ(find("bench").what, "absent");
  for (const auto& [state, trouble] :
       {std::pair{pipeline::BenchState::kFinishing, pipeline::BenchTrouble::kLongFinishing},
        std::pair{pipeline::BenchState::kLoading, pipeline::BenchTrouble::kLongLoading},
        std::pair{pipeline::BenchState::kRunning, pipeline::BenchTrouble::kLongRunning},
        std::pair{pipeline::BenchState::kArmed, pipeline::BenchTrouble::kLongArmed},
        std::pair{pipeline::BenchState::kArmed, pipeline::BenchTrouble::kNegativeForce},
        std::pair{pipeline::BenchState::kFinishing, pipeline::BenchTrouble::kPulledAgain}}) {
    status_ = fmt::format(R"({{"state": "acquiring", "bench": "{}", "bench_trouble": "{}"}})",
                          pipeline::name(state), pipeline::words(trouble));
    const Finding found = find("bench");
    EXPECT_EQ(found.verdict, Verdict::kWarning);
    EXPECT_THAT(found.what, testing::StartsWith(fmt::format("{}: ", pipeline::name(state))));
    EXPECT_EQ(fmt::format("{}: {}", found.what, found.to_do),
              fmt::format("{}: {}", pipeline::name(state), pipeline::words(trouble)));
  }
}

TEST_F(Doctor, JournalsThatWaitAndFoldersThatHideThem) {
  fs::create_directories(folder_ / "records/2026/10");
  EXPECT_EQ(find("records").verdict, Verdict::kGood);
  std::ofstream{folder_ / "records/2026/10/a.journal"} << "x";
  EXPECT_THAT(find("records").what, testing::HasSubstr("1 journals"));
  for (const char* open : {"", "records", "records/2026"}) fs::permissions(folder_ / open, fs::perms::all);
  const test::ClosedFolder closed{folder_ / "records/2026/10"};
  EXPECT_EQ(find("records").verdict, Verdict::kBad);
  EXPECT_THAT(find("records").what, testing::HasSubstr("2026/10: cannot be looked into: Permission denied"));
}

TEST_F(Doctor, AFileSystemThatLacksSomethingIsAWarningWithWhatFollows) {
  EXPECT_EQ(find("filesystem").verdict, Verdict::kGood);
  disk_.flock_error = ENOLCK;
  EXPECT_EQ(find("filesystem").verdict, Verdict::kWarning);
  EXPECT_THAT(find("filesystem").what, testing::HasSubstr("stickslip recover"));
  EXPECT_THAT(find("filesystem").to_do, testing::HasSubstr("ext4"));
  disk_.flock_error = 0;
  disk_.folder_fsync_error = EINVAL;
  EXPECT_THAT(find("filesystem").what, testing::HasSubstr("a power cut may take the newest"));
  disk_.create_error = EROFS;
  EXPECT_EQ(find("filesystem").verdict, Verdict::kBad);
  EXPECT_TRUE(fs::is_empty(folder_ / "records"));
}

// It tried with its own rights, which may be others.
TEST_F(Doctor, ARunningDaemonIsAskedWhatItsFileSystemLacks) {
  disk_.create_error = EACCES;
  status_ =
      R"({"state": "acquiring", "storage": {"lacks": ["record folder r: the file system has no locks"]}})";
  EXPECT_EQ(find("filesystem").verdict, Verdict::kWarning);
  EXPECT_THAT(find("filesystem").what, testing::HasSubstr("has no locks"));
  status_ = R"({"state": "acquiring", "storage": {"lacks": []}})";
  EXPECT_EQ(find("filesystem").verdict, Verdict::kGood);
}

// As `stickslip trend` reads it, whether or not a daemon runs.
TEST_F(Doctor, AnAlarmOfAControlChartIsAWarningWithItsRestart) {
  EXPECT_EQ(find("trend").verdict, Verdict::kGood);
  EXPECT_EQ(find("trend").what, "no test is charted yet");
  std::vector<daemon::HistoryEvent> events;
  for (int i = 0; i < 130; ++i) {
    daemon::TestFinished test{
        .uuid = "u" + std::to_string(i), .status = record::Status::kComplete, .values = {}};
    test.values.file = std::to_string(i) + ".h5";
    test.values.values[static_cast<std::size_t>(trend::Quantity::kZero)] =
        i < 100 ? 0.5 + 0.1 * (i % 2) : 2.0;
    events.push_back({"t", test});
  }
  const daemon::TesterHistory history{folder_ / "records"};
  ASSERT_TRUE(history.append({events.begin(), events.begin() + 100}));
  EXPECT_EQ(find("trend").what, "no alarm of a control chart");
  ASSERT_TRUE(history.append({events.begin() + 100, events.end()}));
  EXPECT_EQ(find("trend").verdict, Verdict::kWarning);
  EXPECT_THAT(find("trend").what, testing::HasSubstr("the zero rose by about"));
  EXPECT_THAT(find("trend").to_do, testing::HasSubstr("/records --restart zero --reason TEXT"));
  // Tests that are void now tell no alarm.
  daemon::BatchJournal journal{folder_ / "records"};
  for (int i = 100; i < 130; ++i)
    ASSERT_TRUE(journal.append({"t", "ada", daemon::TestVoided{std::to_string(i) + ".h5", "torn"}}));
  EXPECT_EQ(find("trend").verdict, Verdict::kGood);
  ASSERT_TRUE(history.append({{"t", daemon::ChartsRestarted{std::nullopt, false, "new cell", "ada"}}}));
  fs::remove(folder_ / "records" / "batches.jsonl");
  EXPECT_EQ(find("trend").verdict, Verdict::kGood);
  fs::remove(folder_ / "records" / daemon::kTesterHistory);
  fs::create_directories(folder_ / "records" / daemon::kTesterHistory);
  EXPECT_EQ(find("trend").verdict, Verdict::kWarning);
}

TEST_F(Doctor, ExitStatusIsThatOfTheWorst) {
  const auto of = [](const std::vector<Verdict>& verdicts) {
    std::vector<Finding> findings;
    findings.reserve(verdicts.size());
    for (const Verdict verdict : verdicts) findings.push_back({"x", verdict, "", ""});
    return exit_status(findings);
  };
  EXPECT_EQ(of({Verdict::kGood}), 0);
  EXPECT_EQ(of({Verdict::kGood, Verdict::kWarning}), 3);
  EXPECT_EQ(of({Verdict::kWarning, Verdict::kBad, Verdict::kGood}), 1);
  EXPECT_EQ(of({Verdict::kUnknown}), 1);
}

}  // namespace
}  // namespace stickslip::doctor
