#include "daemon/app/log.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace stickslip::app {
namespace {

using ::testing::ElementsAre;

/// Keeps the fields of each line, as the journal would get them.
class Fields final : public LogOutput {
 public:
  explicit Fields(std::vector<std::vector<std::string>>& lines) : lines_(lines) {}
  void write(const LogEntry& entry) override { lines_.push_back(journal_fields(entry)); }

 private:
  std::vector<std::vector<std::string>>& lines_;
};

class LogTest : public testing::Test {
 protected:
  std::unique_ptr<daemon::EventReceiver> log(io::LogLevel level = io::LogLevel::kInfo) {
    return make_log(level, std::make_unique<Fields>(lines_));
  }

  std::vector<std::vector<std::string>> lines_;
};

TEST_F(LogTest, AGapIsFoundByItsTestCauseAndScans) {
  log()->gap_seen({1000, 64, true, daq::GapCause::kOverrun}, 7);
  ASSERT_EQ(lines_.size(), 1U);
  EXPECT_THAT(lines_[0],
              ElementsAre("MESSAGE=gap: about 64 scans missing from scan 1000: overrun", "PRIORITY=4",
                          "SYSLOG_IDENTIFIER=stickslipd", "STICKSLIP_EVENT=gap", "STICKSLIP_TEST=7",
                          "STICKSLIP_CAUSE=overrun", "STICKSLIP_FIRST_SCAN=1000", "STICKSLIP_SCAN_COUNT=64"));
}

// A field that means nothing is absent, not empty: `journalctl STICKSLIP_TEST=` would match it.
TEST_F(LogTest, BetweenTestsAGapNamesNone) {
  log()->gap_seen({1000, 64, false, daq::GapCause::kRingFull}, std::nullopt);
  for (const std::string& field : lines_.at(0)) EXPECT_FALSE(field.starts_with("STICKSLIP_TEST")) << field;
}

// Who reads the journal does not know the folder in which the daemon was started.
TEST_F(LogTest, ARecordHasItsWholePath) {
  log()->file_published(7, "records/a.h5");
  EXPECT_THAT(
      lines_.at(0),
      ElementsAre("MESSAGE=test 7: records/a.h5", "PRIORITY=6", "SYSLOG_IDENTIFIER=stickslipd",
                  "STICKSLIP_EVENT=record-finished", "STICKSLIP_TEST=7",
                  fmt::format("STICKSLIP_RECORD={}/records/a.h5", std::filesystem::current_path().string())));
}

TEST_F(LogTest, AMissingBoardIsAStateOfTheDaemon) {
  log()->board_unavailable("board missing", "no such device", 2.0);
  EXPECT_THAT(lines_.at(0),
              ElementsAre("MESSAGE=board missing: no such device; next try in 2 s", "PRIORITY=4",
                          "SYSLOG_IDENTIFIER=stickslipd", "STICKSLIP_EVENT=board-unavailable",
                          "STICKSLIP_STATE=board missing"));
}

TEST_F(LogTest, AFileSystemThatLacksSomethingIsAWarning) {
  log()->record_folder_lacks("record folder r: the file system has no locks");
  EXPECT_THAT(lines_.at(0),
              ElementsAre("MESSAGE=record folder r: the file system has no locks", "PRIORITY=4",
                          "SYSLOG_IDENTIFIER=stickslipd", "STICKSLIP_EVENT=record-folder-lacks"));
}

TEST_F(LogTest, WhatIsBelowTheLevelIsLeftOut) {
  const std::unique_ptr<daemon::EventReceiver> events = log(io::LogLevel::kWarning);
  events->stopping("told to");
  EXPECT_TRUE(lines_.empty());
  events->storage_waits("no space");
  EXPECT_EQ(lines_.size(), 1U);
}

TEST_F(LogTest, AJournalThatWasWrittenAnewSaysWhereItStands) {
  log()->journal_written_anew(7, "records/a.journal", "records/a-2.journal");
  EXPECT_EQ(
      lines_.at(0).at(0),
      "MESSAGE=test 7: the journal was removed, renamed or replaced while it was open: records/a.journal; "
      "all of it was written anew: records/a-2.journal");
  EXPECT_EQ(lines_.at(0).at(1), "PRIORITY=4");
  EXPECT_EQ(lines_.at(0).at(3), "STICKSLIP_EVENT=journal-written-anew");
}

TEST_F(LogTest, ADamagedRecordIsAWarning) {
  log(io::LogLevel::kWarning)->record_damaged("records/a.h5", "122 bytes of its journal could not be read");
  ASSERT_EQ(lines_.size(), 1U);
  EXPECT_EQ(lines_[0].at(1), "PRIORITY=4");
  EXPECT_EQ(lines_[0].at(3), "STICKSLIP_EVENT=record-damaged");
}

TEST_F(LogTest, ScansThatTheDiskDamagedAreNotInRecords) {
  log()->scans_accounted({.issued = 10, .idle = 4, .in_gaps = 1, .recorded = 3, .damaged = 2});
  ASSERT_EQ(lines_.size(), 2U);
  EXPECT_EQ(lines_[0].at(1), "PRIORITY=3");
  EXPECT_EQ(lines_[0].at(3), "STICKSLIP_EVENT=scans-damaged");
  EXPECT_EQ(lines_[1].at(3), "STICKSLIP_EVENT=scans-accounted");
}

// What is lost to nobody's knowledge is an error of its own kind, so that an alarm can be set on it.
TEST_F(LogTest, ScansUnaccountedForAreAnEventOfTheirOwn) {
  const std::unique_ptr<daemon::EventReceiver> events = log();
  events->scans_accounted({.issued = 10, .idle = 4, .in_gaps = 1, .recorded = 5});
  events->scans_accounted({.issued = 10, .idle = 4, .in_gaps = 1, .recorded = 3});
  ASSERT_EQ(lines_.size(), 2U);
  EXPECT_EQ(lines_[0].at(3), "STICKSLIP_EVENT=scans-accounted");
  EXPECT_EQ(lines_[1].at(1), "PRIORITY=3");
  EXPECT_EQ(lines_[1].at(3), "STICKSLIP_EVENT=scans-unaccounted");
  EXPECT_EQ(lines_[1].at(4), "STICKSLIP_SCAN_COUNT=2");
}

// JOURNAL_STREAM is inherited; a stderr that was redirected since is no journal [systemd.exec(5)].
TEST(Journal, IsWhereTheVariableSaysThatTheDescriptorLeads) {
  const int file = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  ASSERT_GE(file, 0);
  struct stat status {};
  ASSERT_EQ(::fstat(file, &status), 0);
  const std::string here = fmt::format("{}:{}", status.st_dev, status.st_ino);
  EXPECT_TRUE(leads_to_journal(file, here.c_str()));
  EXPECT_FALSE(leads_to_journal(file, (here + "0").c_str()));
  EXPECT_FALSE(leads_to_journal(file, "1"));
  EXPECT_FALSE(leads_to_journal(file, nullptr));
  ::close(file);
  EXPECT_FALSE(leads_to_journal(-1, here.c_str()));
}

}  // namespace
}  // namespace stickslip::app
