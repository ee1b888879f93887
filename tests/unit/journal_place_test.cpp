// A journal whose path does not lead to it any more: nothing of it is lost, and nothing else is overwritten.

#include <gmock/gmock.h>

#include <atomic>
#include <fstream>

#include "core/record/journal.hpp"
#include "core/record/journal_care.hpp"
#include "core/record/patient_journal.hpp"
#include "tests/support/faulty_disk.hpp"
#include "tests/support/moving_disk.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip {
namespace {

using record::PatientJournal;
using test::MovingDisk;
using test::TemporaryFolder;
namespace fs = std::filesystem;

class JournalPlace : public testing::Test {
 protected:
  static constexpr std::size_t kScans = 35;
  static constexpr std::size_t kPlenty = std::size_t{1} << 20U;

  void begin(const record::FileCalls& calls) {
    fs::create_directory(folder_ / "records");
    journal_.emplace(folder_ / "records" / "a.journal", test::sample_header(), kPlenty, calls);
    add();
    ASSERT_EQ(journal_->save(), std::nullopt);
    ASSERT_EQ(journal_->path(), folder_ / "records" / "a.journal");
  }
  void add() {
    ASSERT_TRUE(journal_->add_scans(next_, std::vector<double>(kScans, static_cast<double>(next_)), {}));
    next_ += static_cast<daq::ScanIndex>(kScans);
  }
  /// All that was added, where the journal says that it stands.
  void expect_all() const {
    const auto read = record::read_journal(journal_->path());
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_TRUE(read->damaged.empty());
    ASSERT_EQ(read->record.scan.size(), static_cast<std::size_t>(next_));
    for (std::size_t i = 0; i < read->record.scan.size(); ++i) {
      ASSERT_EQ(read->record.scan[i], static_cast<daq::ScanIndex>(i));
      ASSERT_EQ(read->record.raw[i], static_cast<double>(i - i % kScans));
    }
  }

  const TemporaryFolder folder_;
  MovingDisk disk_;
  std::optional<PatientJournal> journal_;
  daq::ScanIndex next_ = 0;
};

TEST_F(JournalPlace, AnUnlinkedJournalIsWrittenAnew) {
  begin(disk_);
  fs::remove(journal_->path());
  add();
  EXPECT_EQ(journal_->save(), std::nullopt);
  EXPECT_EQ(journal_->anew_count(), 1);
  EXPECT_EQ(journal_->path(), folder_ / "records" / "a.journal");
  expect_all();
  add();
  EXPECT_EQ(journal_->save(), std::nullopt);
  EXPECT_EQ(journal_->anew_count(), 1);
  expect_all();
  EXPECT_FALSE(record::JournalLock::take(journal_->path()));
}

TEST_F(JournalPlace, NothingIsWrittenAndItIsSeenAllTheSame) {
  begin(disk_);
  fs::remove(journal_->path());
  EXPECT_TRUE(journal_->saved());
  EXPECT_EQ(journal_->ensure_at_path(), std::nullopt);
  expect_all();
}

TEST_F(JournalPlace, AnotherFileAtThePathIsNotOverwritten) {
  begin(disk_);
  fs::remove(journal_->path());
  std::ofstream{folder_ / "records" / "a.journal"} << "somebody's notes";
  add();
  EXPECT_EQ(journal_->save(), std::nullopt);
  EXPECT_EQ(test::content_of(folder_ / "records" / "a.journal"), "somebody's notes");
  EXPECT_EQ(journal_->path(), folder_ / "records" / "a-2.journal");
  expect_all();
}

// Copied and put back: another file, as old as the copy.
TEST_F(JournalPlace, ACopyInItsPlaceIsAnotherFile) {
  begin(disk_);
  fs::copy(journal_->path(), folder_ / "copy");
  fs::rename(folder_ / "copy", journal_->path());
  add();
  EXPECT_EQ(journal_->save(), std::nullopt);
  EXPECT_EQ(journal_->path(), folder_ / "records" / "a-2.journal");
  expect_all();
}

TEST_F(JournalPlace, ALinkInItsPlaceIsAnotherFile) {
  begin(disk_);
  fs::rename(journal_->path(), folder_ / "moved");
  fs::create_symlink(folder_ / "moved", journal_->path());
  add();
  EXPECT_EQ(journal_->save(), std::nullopt);
  EXPECT_EQ(journal_->path(), folder_ / "records" / "a-2.journal");
  expect_all();
}

// Numbers of files are those of their file system: another one is mounted there, and has one of that number.
TEST_F(JournalPlace, AFileOfTheSameNumberOnAnotherDeviceIsAnotherFile) {
  begin(disk_);
  fs::rename(folder_ / "records", folder_ / "elsewhere");
  fs::create_directory(folder_ / "records");
  fs::create_hard_link(folder_ / "elsewhere" / "a.journal", journal_->path());
  disk_.mount(folder_ / "records", 1);
  add();
  EXPECT_EQ(journal_->save(), std::nullopt);
  EXPECT_EQ(journal_->path(), folder_ / "records" / "a-2.journal");
  expect_all();
}

/// A file system that goes on finding a file by its name when it is gone already, as a cache of names does.
class OldNames final : public test::ForwardingCalls {
 public:
  void remove(const fs::path& file) {
    struct stat found {};
    ASSERT_EQ(::lstat(file.c_str(), &found), 0);
    gone_ = found.st_ino;
  }
  int fstat(int file, struct ::stat* found) const override {
    const int status = ForwardingCalls::fstat(file, found);
    if (status == 0 && found->st_ino == gone_) found->st_nlink = 0;
    return status;
  }

 private:
  std::atomic<ino_t> gone_{0};
};

TEST_F(JournalPlace, AFileWithoutANameIsGoneAlthoughItIsStillFound) {
  OldNames names;
  begin(names);
  names.remove(journal_->path());
  add();
  EXPECT_EQ(journal_->save(), std::nullopt);
  EXPECT_EQ(journal_->path(), folder_ / "records" / "a-2.journal");
  expect_all();
  journal_.reset();
}

TEST_F(JournalPlace, AFileThatWasThereFirstIsNotOverwritten) {
  fs::create_directory(folder_ / "records");
  std::ofstream{folder_ / "records" / "a.journal"} << "somebody's notes";
  journal_.emplace(folder_ / "records" / "a.journal", test::sample_header(), kPlenty, disk_);
  add();
  EXPECT_EQ(journal_->save(), std::nullopt);
  EXPECT_EQ(journal_->path(), folder_ / "records" / "a-2.journal");
  expect_all();
}

TEST_F(JournalPlace, AFolderThatWasRenamedIsMadeAgain) {
  begin(disk_);
  fs::rename(folder_ / "records", folder_ / "elsewhere");
  add();
  EXPECT_EQ(journal_->save(), std::nullopt);
  EXPECT_EQ(journal_->path(), folder_ / "records" / "a.journal");
  expect_all();
}

class CannotLook : public JournalPlace, public testing::WithParamInterface<int> {};

TEST_P(CannotLook, IsNotGone) {
  begin(disk_);
  disk_.hide(folder_ / "records", GetParam());
  add();
  EXPECT_THAT(journal_->save().value_or(""), testing::HasSubstr(std::strerror(GetParam())));
  EXPECT_GT(journal_->waiting_size(), 0U);
  disk_.hide({}, 0);
  EXPECT_EQ(journal_->save(), std::nullopt);
  EXPECT_EQ(journal_->anew_count(), 0);
  expect_all();
}

INSTANTIATE_TEST_SUITE_P(Errors, CannotLook, testing::Values(EACCES, ESTALE, EIO, ENOTDIR),
                         [](const auto& error) { return std::string{::strerrorname_np(error.param)}; });

TEST_F(JournalPlace, WhatCannotBeReadBackWaitsAndSaysSo) {
  begin(disk_);
  fs::remove(journal_->path());
  disk_.refuse_reads(EIO);
  add();
  EXPECT_THAT(journal_->save().value_or(""), testing::HasSubstr("cannot be read back"));
  EXPECT_TRUE(fs::is_empty(folder_ / "records"));
  disk_.refuse_reads(0);
  EXPECT_EQ(journal_->save(), std::nullopt);
  expect_all();
}

// Each call that writes it anew is refused, each in its turn.
TEST_F(JournalPlace, NothingIsLostWhereItIsRefused) {
  constexpr int kMoreThanThereAre = 12;
  for (int call = 0; call < kMoreThanThereAre; ++call) {
    test::FaultyDisk faulty;
    next_ = 0;
    fs::remove_all(folder_ / "records");
    begin(faulty);
    fs::remove_all(folder_ / "records");
    add();
    faulty.refuse(call, 1, ENOSPC);
    static_cast<void>(journal_->save());
    faulty.works_again();
    EXPECT_EQ(journal_->save(), std::nullopt) << call;
    expect_all();
  }
}

TEST_F(JournalPlace, AJournalWhoseRecordIsMadeIsNotWrittenAnew) {
  begin(disk_);
  journal_->hand_over();
  EXPECT_TRUE(record::JournalLock::take(journal_->path()));
  // As long as there is no record, it is; and others may still finish it.
  fs::remove(journal_->path());
  EXPECT_EQ(journal_->ensure_at_path(), std::nullopt);
  expect_all();
  EXPECT_TRUE(record::JournalLock::take(journal_->path()));
  std::ofstream{folder_ / "records" / "a.h5"} << "its record";
  fs::remove(journal_->path());
  EXPECT_EQ(journal_->ensure_at_path(), std::nullopt);
  EXPECT_FALSE(fs::exists(journal_->path()));
  EXPECT_EQ(journal_->anew_count(), 1);
}

}  // namespace
}  // namespace stickslip
