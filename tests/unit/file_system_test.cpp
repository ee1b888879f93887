// File systems that lack something, and files that cannot be looked at: by an interposed table of calls.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <hdf5.h>
#include <sys/file.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/sanitized.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/folder_probe.hpp"
#include "core/record/given_file.hpp"
#include "core/record/journal_care.hpp"
#include "core/record/reader.hpp"
#include "core/record/verdict.hpp"
#include "tests/support/faulty_disk.hpp"
#include "tests/support/journal_samples.hpp"
#include "tests/support/lacking_disk.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::record {
namespace {

using test::LackingDisk;
using test::TemporaryFolder;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

class FileSystem : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(publish_record(test::whole_record(), record_)); }

  /// Neither damaged nor good, and no reader says otherwise.
  void expect_not_judged(const std::string& why, base::ErrorKind kind) {
    const Verdict verdict = judge(record_, disk_);
    EXPECT_EQ(verdict.judgement, Judgement::kNotJudged) << why;
    ASSERT_EQ(verdict.findings.size(), 1U) << why;
    EXPECT_THAT(verdict.findings[0].text, HasSubstr(why));
    const auto read = read_record(record_, disk_);
    ASSERT_FALSE(read) << why;
    EXPECT_THAT(read.error().message, HasSubstr(why));
    EXPECT_THAT(read.error().message, testing::Not(HasSubstr("backup")));
    EXPECT_EQ(read.error().kind, kind) << read.error().message;
  }

  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator{folder_.path()})
      found.push_back(entry.path().filename().string());
    std::sort(found.begin(), found.end());
    return found;
  }

  const TemporaryFolder folder_;
  fs::path record_ = folder_ / "a.h5";
  LackingDisk disk_;
};

// ---- cannot look is not damaged -------------------------------------------------------------

TEST_F(FileSystem, WhatTheSystemRefusesToOpenIsNotJudged) {
  for (const int error : {EACCES, EPERM}) {
    disk_.open_error = error;
    expect_not_judged("chmod a+r", base::ErrorKind::kNoPermission);
  }
  for (const int error : {EMFILE, ENFILE}) {
    disk_.open_error = error;
    expect_not_judged("ulimit -n", base::ErrorKind::kFailure);
  }
  for (const int error : {EIO, ESTALE, ENOTCONN}) {
    disk_.open_error = error;
    expect_not_judged("cannot be read now", base::ErrorKind::kFailure);
  }
  disk_.open_error = ENOENT;
  expect_not_judged("there is no such file", base::ErrorKind::kUsage);
}

// The place decides what HDF5 is doing when the disk refuses; it must not decide the verdict.
TEST_F(FileSystem, ADiskThatRefusesAReadAnywhereIsNotDamage) {
  const auto size = static_cast<off_t>(fs::file_size(record_));
  for (const int error : {EIO, ESTALE, ENOTCONN}) {
    disk_.pread_error = error;
    for (off_t from = 0; from < size; from += size / 61) {
      disk_.pread_from = from;
      SCOPED_TRACE(from);
      const Verdict verdict = judge(record_, disk_);
      ASSERT_EQ(verdict.judgement, Judgement::kNotJudged);
      ASSERT_THAT(verdict.findings.at(0).text, HasSubstr("cannot be read now"));
      const auto read = read_record(record_, disk_);
      // Not every byte is needed for the values.
      if (!read) {
        ASSERT_EQ(read.error().kind, base::ErrorKind::kFailure) << read.error().message;
        ASSERT_THAT(read.error().message, HasSubstr("cannot be read now"));
      }
    }
  }
  disk_.pread_error = 0;
  EXPECT_EQ(judge(record_, disk_).judgement, Judgement::kComplete);
}

TEST_F(FileSystem, AJournalOnADiskThatRefusesReadsIsNotJudged) {
  test::write_journal(folder_ / "b.journal", test::whole_record());
  disk_.pread_error = EIO;
  const auto size = static_cast<off_t>(fs::file_size(folder_ / "b.journal"));
  for (off_t from = 0; from < size; from += size / 7) {
    disk_.pread_from = from;
    EXPECT_EQ(judge(folder_ / "b.journal", disk_).judgement, Judgement::kNotJudged) << from;
  }
}

// As h5py does in mode r+.
TEST_F(FileSystem, ARecordThatAnotherProgramWritesIsOpenElsewhereNotDamaged) {
  const int other = ::open(record_.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(::flock(other, LOCK_EX | LOCK_NB), 0);
  expect_not_judged("is open for writing in another program: close it there", base::ErrorKind::kBusy);
  // A reader's lock is in nobody's way.
  ASSERT_EQ(::flock(other, LOCK_SH | LOCK_NB), 0);
  EXPECT_EQ(judge(record_).judgement, Judgement::kComplete);
  ::close(other);
  EXPECT_EQ(judge(record_).judgement, Judgement::kComplete);
}

TEST_F(FileSystem, AReaderKeepsThoseWhoLockFromWriting) {
  const auto reader = open_shared(record_);
  ASSERT_TRUE(reader);
  EXPECT_LT(H5Fopen(record_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), 0);
}

TEST_F(FileSystem, AnyVariableOfHdf5AboutLocksChangesNothing) {
  for (const char* value : {"TRUE", "FALSE", "BEST_EFFORT"}) {
    ASSERT_EQ(::setenv("HDF5_USE_FILE_LOCKING", value, 1), 0);
    EXPECT_TRUE(publish_record(test::whole_record(), folder_ / (std::string{value} + ".h5")));
    EXPECT_TRUE(read_record(record_));
  }
  ::unsetenv("HDF5_USE_FILE_LOCKING");
}

// ---- without locks --------------------------------------------------------------------------

TEST_F(FileSystem, WithoutLocksRecordsAreMadeAndRead) {
  for (const int error : {ENOLCK, ENOSYS, EOPNOTSUPP, EINVAL}) {
    SCOPED_TRACE(error);
    disk_.flock_error = error;
    EXPECT_EQ(judge(record_, disk_).judgement, Judgement::kComplete);
    EXPECT_TRUE(read_record(record_, disk_));
    const fs::path journal = folder_ / ("e" + std::to_string(error) + ".journal");
    test::write_journal(journal, test::whole_record());
    const auto made = finalise(journal, nullptr, disk_);
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_EQ(judge(made->file).judgement, Judgement::kComplete);
    EXPECT_FALSE(fs::exists(journal));
  }
}

TEST_F(FileSystem, CountsWithoutAGainMakeNoRecord) {
  Record record = test::whole_record();
  ASSERT_EQ(record.header.board.quantity, daq::RawQuantity::kCounts);
  record.header.load_cell.reset();
  const auto published = publish_record(record, folder_ / "b.h5");
  ASSERT_FALSE(published);
  EXPECT_THAT(published.error().message, HasSubstr("no gain"));
  EXPECT_EQ(names(), std::vector<std::string>{"a.h5"});
}

TEST_F(FileSystem, WithoutLocksJournalsAreWritten) {
  disk_.flock_error = ENOLCK;
  auto journal = JournalWriter::create(folder_ / "b.journal", test::whole_record().header, disk_);
  ASSERT_TRUE(journal) << journal.error().message;
  EXPECT_TRUE(journal->sync());
}

// ---- names ----------------------------------------------------------------------------------

class Names : public FileSystem, public testing::WithParamInterface<std::pair<int, int>> {
 protected:
  void SetUp() override {
    FileSystem::SetUp();
    disk_.rename_to_new_error = GetParam().first;
    disk_.link_error = GetParam().second;
  }
};

TEST_P(Names, AFileGetsAFreeNameAndNeverOneThatIsTaken) {
  test::write_content(folder_ / "from", "new");
  test::write_content(folder_ / "taken", "old");
  const auto refused = rename_to_new(folder_ / "from", folder_ / "taken", disk_);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, base::ErrorKind::kUsage);
  EXPECT_EQ(test::content_of(folder_ / "taken"), "old");
  EXPECT_EQ(test::content_of(folder_ / "from"), "new");
  const auto done = rename_to_new(folder_ / "from", folder_ / "free", disk_);
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_EQ(test::content_of(folder_ / "free"), "new");
  EXPECT_EQ(names(), (std::vector<std::string>{"a.h5", "free", "taken"}));
}

TEST_P(Names, ALinkThatLeadsNowhereIsTakenToo) {
  test::write_content(folder_ / "from", "new");
  fs::create_symlink(folder_ / "absent", folder_ / "dangling");
  EXPECT_FALSE(rename_to_new(folder_ / "from", folder_ / "dangling", disk_));
  EXPECT_FALSE(fs::exists(folder_ / "absent"));
}

TEST_P(Names, RecordsAreMade) {
  test::write_journal(folder_ / "b.journal", test::whole_record());
  const auto made = finalise(folder_ / "b.journal", nullptr, disk_);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(judge(folder_ / "b.h5").judgement, Judgement::kComplete);
  EXPECT_EQ(names(), (std::vector<std::string>{"a.h5", "b.h5"}));
}

INSTANTIATE_TEST_SUITE_P(Lacking, Names,
                         testing::Values(std::pair{EINVAL, 0}, std::pair{ENOSYS, 0}, std::pair{EINVAL, EPERM},
                                         std::pair{EINVAL, EOPNOTSUPP}, std::pair{ENOSYS, ENOSYS}));

// A stop between the two steps of a name, where a rename is two steps.
TEST_F(FileSystem, ANameThatWasTakenByAStopIsGivenToTheRecord) {
  test::write_journal(folder_ / "b.journal", test::whole_record());
  test::write_content(folder_ / "b.h5", "");
  ASSERT_TRUE(finalise(folder_ / "b.journal"));
  EXPECT_EQ(judge(folder_ / "b.h5").judgement, Judgement::kComplete);
}

// A second name that a stop left belongs to the record that somebody has moved away meanwhile.
TEST_F(FileSystem, AnUnfinishedFileIsMadeAnewNotEmptied) {
  const std::string whole = test::content_of(record_);
  fs::create_hard_link(record_, folder_ / "b.h5.part");
  Record other = test::whole_record();
  other.header.title = "another test";
  test::write_journal(folder_ / "b.journal", other);
  ASSERT_TRUE(finalise(folder_ / "b.journal"));
  EXPECT_EQ(test::content_of(record_), whole);
  EXPECT_EQ(names(), (std::vector<std::string>{"a.h5", "b.h5"}));
}

TEST_F(FileSystem, AnUnfinishedFileThatIsALinkIsNotFollowed) {
  test::write_content(folder_ / "precious", "of somebody else");
  fs::create_symlink(folder_ / "precious", folder_ / "b.h5.part");
  ASSERT_TRUE(publish_record(test::whole_record(), folder_ / "b.h5"));
  EXPECT_EQ(test::content_of(folder_ / "precious"), "of somebody else");
}

TEST_F(FileSystem, ARecordThatIsOpenElsewhereIsNoStrangerToItsJournal) {
  test::write_journal(folder_ / "a.journal", test::whole_record());
  const int other = ::open(record_.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(::flock(other, LOCK_EX | LOCK_NB), 0);
  const auto waits = finalise(folder_ / "a.journal");
  ASSERT_FALSE(waits);
  EXPECT_THAT(waits.error().message, HasSubstr("is open for writing in another program"));
  EXPECT_TRUE(fs::exists(folder_ / "a.journal"));
  ::close(other);
}

TEST_F(FileSystem, AJournalThatCannotBeReadNowIsNotComparedAndWaits) {
  const fs::path journal = folder_ / "a.journal";
  int told = 0;
  test::FaultyDisk disk;
  disk.count_reads();
  int refused = 0;
  for (bool was_refused = true; was_refused; ++refused) {
    SCOPED_TRACE(refused);
    if (!fs::exists(journal)) test::write_journal(journal, test::whole_record());
    disk.refuse(refused, 1, EIO);
    const auto made = finalise(journal, nullptr, disk);
    was_refused = disk.calls() > refused;
    ASSERT_TRUE(fs::exists(record_));
    if (made) continue;
    ASSERT_EQ(made.error().kind, base::ErrorKind::kFailure);
    ASSERT_THAT(made.error().message, testing::Not(HasSubstr("other scans")));
    if (made.error().message.find("cannot be compared with its scans now") != std::string::npos) ++told;
    ASSERT_TRUE(fs::exists(journal) || made.error().message.find("durable") != std::string::npos);
  }
  EXPECT_GT(told, 0);
}

// ---- syncing --------------------------------------------------------------------------------

TEST_F(FileSystem, FoldersThatCannotBeSyncedRefuseNothing) {
  for (const int error : {EINVAL, EOPNOTSUPP, EBADF, ENOSYS}) {
    SCOPED_TRACE(error);
    disk_.folder_fsync_error = error;
    EXPECT_TRUE(sync_folder(folder_.path(), disk_));
    EXPECT_TRUE(make_folders(folder_ / std::to_string(error) / "b", disk_));
    const fs::path journal = folder_ / ("e" + std::to_string(error) + ".journal");
    ASSERT_TRUE(JournalWriter::create(journal, test::whole_record().header, disk_));
    fs::remove(journal);
    test::write_journal(journal, test::whole_record());
    const auto made = finalise(journal, nullptr, disk_);
    ASSERT_TRUE(made) << made.error().message;
  }
}

TEST_F(FileSystem, AFileInPlaceOfAFolderIsNoFolder) {
  test::write_content(folder_ / "file", "x");
  for (const fs::path& path : {folder_ / "file", folder_ / "file" / "b"}) {
    const auto made = make_folders(path, disk_);
    ASSERT_FALSE(made) << path;
    EXPECT_EQ(made.error().message, (folder_ / "file").string() + ": is no folder: move it away");
  }
}

TEST_F(FileSystem, ADiskThatFailsIsNoFileSystemThatCannotSync) {
  for (const int error : {EIO, ENOSPC, EROFS, EDQUOT}) {
    disk_.folder_fsync_error = error;
    EXPECT_FALSE(sync_folder(folder_.path(), disk_)) << error;
    EXPECT_FALSE(JournalWriter::create(folder_ / "b.journal", test::whole_record().header, disk_)) << error;
  }
}

// ---- a disk that is full for a moment ---------------------------------------------------------

// HDF5 writes the last bytes of a data set when it is closed, by a destructor, which cannot report an error.
TEST_F(FileSystem, ARecordOfWhichACallWasRefusedIsNotPublished) {
  fs::remove(record_);
  const fs::path journal = folder_ / "a.journal";
  const fs::path whole = folder_ / "whole.journal";
  test::write_journal(whole, test::whole_record());
  // Among writes every third call, which takes a data set and more; among all calls each thirteenth.
  constexpr int kThinner = base::kSanitized ? 3 : 1;
  for (const bool reads : {false, true}) {
    const int step = (reads ? 13 : 3) * kThinner;
    test::FaultyDisk disk;
    if (reads) disk.count_reads();
    int refused = 0;
    for (bool was_refused = true; was_refused; refused += step) {
      SCOPED_TRACE(refused);
      fs::copy_file(whole, journal);
      disk.refuse(refused, 1, ENOSPC);
      const auto made = finalise(journal, nullptr, disk);
      was_refused = disk.calls() > refused;
      // Where the removal of the journal was refused, the record is published.
      EXPECT_TRUE(fs::exists(record_) || (!made && fs::exists(journal)));
      EXPECT_TRUE(!fs::exists(record_) || judge(record_).judgement == Judgement::kComplete);
      fs::remove(journal);
      fs::remove(record_);
    }
    EXPECT_GT(refused, 300);
  }
}

// ---- the probe ------------------------------------------------------------------------------

std::string told(const base::Result<std::vector<FolderLack>>& lacks) {
  std::string text;
  if (!lacks) return "refused: " + lacks.error().message;
  for (const FolderLack& lack : *lacks) text += lack.what + ": " + lack.follows + "\n";
  return text;
}

TEST_F(FileSystem, TheProbeFindsNothingHereAndLeavesNothing) {
  EXPECT_EQ(told(probe_folder(folder_.path())), "");
  EXPECT_EQ(names(), std::vector<std::string>{"a.h5"});
}

TEST_F(FileSystem, TheProbeSaysWhatIsLackingAndWhatFollows) {
  disk_.flock_error = ENOLCK;
  EXPECT_THAT(told(probe_folder(folder_.path(), disk_)),
              HasSubstr("has no locks (flock: No locks available)"));
  disk_.flock_error = 0;
  disk_.folder_fsync_error = EINVAL;
  EXPECT_THAT(told(probe_folder(folder_.path(), disk_)), HasSubstr("cannot sync folders"));
  disk_.folder_fsync_error = 0;
  disk_.tells_room = false;
  EXPECT_THAT(told(probe_folder(folder_.path(), disk_)), HasSubstr("does not tell how much room"));
  disk_.tells_room = true;
  disk_.rename_to_new_error = EINVAL;
  EXPECT_EQ(told(probe_folder(folder_.path(), disk_)), "");  // link() does as well.
  disk_.link_error = EPERM;
  EXPECT_THAT(told(probe_folder(folder_.path(), disk_)), HasSubstr("can rename only by replacing"));
  EXPECT_EQ(names(), std::vector<std::string>{"a.h5"});
}

TEST_F(FileSystem, TheProbeRefusesAFolderInWhichNoRecordCanBe) {
  disk_.create_error = EROFS;
  EXPECT_EQ(told(probe_folder(folder_.path(), disk_)), "refused: cannot be written: Read-only file system");
  disk_.create_error = 0;
  disk_.fsync_error = EINVAL;
  EXPECT_EQ(told(probe_folder(folder_.path(), disk_)),
            "refused: files in it cannot be synced: Invalid argument");
  disk_.fsync_error = 0;
  disk_.open_error = EACCES;  // Mode -wx.
  EXPECT_EQ(told(probe_folder(folder_.path(), disk_)),
            "refused: cannot be opened for reading, which its sync needs: Permission denied");
  EXPECT_EQ(names(), std::vector<std::string>{"a.h5"});
}

TEST_F(FileSystem, TheProbeToleratesAFullDisk) {
  for (const int error : {ENOSPC, EDQUOT}) {
    disk_.create_error = error;
    EXPECT_EQ(told(probe_folder(folder_.path(), disk_)), "");
    disk_.create_error = 0;
    disk_.fsync_error = disk_.folder_fsync_error = error;
    EXPECT_EQ(told(probe_folder(folder_.path(), disk_)), "");
    disk_.fsync_error = disk_.folder_fsync_error = 0;
  }
}

TEST_F(FileSystem, TheProbeRemovesWhatAKillLeftAndNotThatOfAnother) {
  test::write_content(folder_ / ".stickslip-probe-left", "");
  test::write_content(folder_ / ".stickslip-probe-live", "");
  const int live = ::open((folder_ / ".stickslip-probe-live").c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(::flock(live, LOCK_EX | LOCK_NB), 0);
  EXPECT_EQ(told(probe_folder(folder_.path())), "");
  EXPECT_EQ(names(), (std::vector<std::string>{".stickslip-probe-live", "a.h5"}));
  ::close(live);
}

}  // namespace
}  // namespace stickslip::record
