// A journal on a disk that refuses: every call of the system is refused once, each in its turn, with every
// error that a full, failing or read-only disk gives.

#include "core/record/patient_journal.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>

#include "core/record/finaliser.hpp"
#include "core/record/journal.hpp"
#include "core/record/reader.hpp"
#include "core/record/verdict.hpp"
#include "tests/support/faulty_disk.hpp"
#include "tests/support/record_samples.hpp"
#include "tests/support/sanitized.hpp"

#ifdef STICKSLIP_SANITIZED
// HDF5 keeps what a failed close leaves, which is why the daemon finalises in a process of its own.
extern "C" const char* __lsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier) asked by LSan
  return "leak:libhdf5";
}
#endif

namespace stickslip {
namespace {

using record::PatientJournal;
using test::FaultyDisk;
using test::TemporaryFolder;
namespace fs = std::filesystem;

constexpr std::size_t kMemory = std::size_t{1} << 20U;
constexpr std::size_t kScansInEntry = 35;

record::EndRecord sound_end() {
  record::EndRecord end = test::sample_end();
  end.status = record::Status::kComplete;
  end.reasons.clear();
  end.spikes.clear();
  end.truth.reset();
  return end;
}

/// A test as it comes, a settling after each second; \return how many settlings were refused.
int write_test(PatientJournal& journal, int seconds) {
  int refused = 0;
  daq::ScanIndex next = 0;
  for (int second = 0; second < seconds; ++second) {
    for (int entry = 0; entry < 3; ++entry) {
      journal.add_scans(next, std::vector<double>(kScansInEntry, static_cast<double>(next)), {});
      next += static_cast<daq::ScanIndex>(kScansInEntry);
      if (journal.write()) ++refused;
    }
    if (journal.save()) ++refused;
  }
  journal.add_end(sound_end());
  return refused;
}

// A disk that was full has room for the record of a test as soon as its journal is over.
TEST(PatientJournal, RoomReservedBehindTheEndIsGivenBack) {
  const test::TemporaryFolder folder;
  PatientJournal journal{folder.path() / "a.journal", test::sample_header(), kMemory};
  write_test(journal, 2);
  ASSERT_FALSE(journal.save());
  const auto allocated = [&] {
    struct stat facts {};
    EXPECT_EQ(::stat(journal.path().c_str(), &facts), 0);
    constexpr std::int64_t kUnit = 512;  // Of st_blocks.
    return facts.st_blocks * kUnit - facts.st_size;
  };
  constexpr std::int64_t kFileSystemBlock = 64 << 10;
  if (allocated() <= kFileSystemBlock) GTEST_SKIP() << "this file system reserves nothing";
  journal.give_room_back();
  EXPECT_LE(allocated(), kFileSystemBlock);
  EXPECT_FALSE(journal.save());
}

/// All scans in order, each value the first scan of its entry.
void expect_all(const record::Record& record, std::size_t count) {
  ASSERT_EQ(record.scan.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    ASSERT_EQ(record.scan[i], static_cast<daq::ScanIndex>(i));
    ASSERT_EQ(record.raw[i], static_cast<double>(i - i % kScansInEntry));
  }
}

class RefusedOnce : public testing::TestWithParam<int> {};

TEST_P(RefusedOnce, AtEveryCallOfTheSystemNothingIsLost) {
  const TemporaryFolder folder;
  int calls = 0;
  {
    FaultyDisk disk;
    PatientJournal journal{folder / "whole.journal", test::sample_header(), kMemory, disk};
    EXPECT_EQ(write_test(journal, 4), 0);
    EXPECT_FALSE(journal.save());
    calls = disk.calls();
  }
  ASSERT_GT(calls, 20);
  for (int call = 0; call < calls; ++call) {
    // One refusal, and a second that hits what cuts back and tries again.
    for (const int count : {1, 2, 5}) {
      const fs::path path = folder / fmt::format("{}-{}.journal", call, count);
      FaultyDisk disk;
      disk.refuse(call, count, GetParam());
      PatientJournal journal{path, test::sample_header(), kMemory, disk};
      write_test(journal, 4);
      disk.works_again();
      EXPECT_EQ(journal.save(), std::nullopt) << call;
      EXPECT_EQ(journal.waiting_size(), 0U);
      const auto read = record::read_journal(path);
      ASSERT_TRUE(read) << call << ": " << read.error().message;
      EXPECT_EQ(read->why_unread(), "") << call;
      ASSERT_TRUE(read->record.end) << call;
      EXPECT_EQ(read->record.end->status, record::Status::kComplete);
      expect_all(read->record, 4 * 3 * kScansInEntry);
    }
  }
}

TEST_P(RefusedOnce, TheFinaliserLeavesTheJournalAndNoHalfFile) {
  const TemporaryFolder folder;
  const auto write = [&](const fs::path& path) {
    const test::HastyCalls disk;
    PatientJournal journal{path, test::sample_header(), kMemory, disk};
    write_test(journal, 2);
    ASSERT_EQ(journal.save(), std::nullopt);
  };
  write(folder / "a.journal");
  FaultyDisk counting;
  ASSERT_TRUE(record::finalise(folder / "a.journal", {}, counting));
  const std::string finished = test::content_of(folder / "a.h5");
  // HDF5 writes many small pieces: some of them.
  const int step = std::max(1, counting.calls() / 10);
  for (int call = 0; call < counting.calls(); call += step) {
    const fs::path path = folder / fmt::format("b{}.journal", call);
    write(path);
    fs::path file = path;
    file.replace_extension(".h5");
    FaultyDisk disk;
    // It goes on refusing: unlinking what was begun may fail too.
    disk.refuse(call, 1'000'000, GetParam());
    const auto refused = record::finalise(path, {}, disk);
    disk.works_again();
    EXPECT_FALSE(refused) << call;
    EXPECT_TRUE(fs::exists(path) || fs::exists(file)) << call;
    if (fs::exists(path)) {
      const auto again = record::finalise(path, {}, disk);
      ASSERT_TRUE(again) << call << ": " << again.error().message;
    }
    EXPECT_EQ(record::judge(file).judgement, record::Judgement::kComplete) << call;
    expect_all(*record::read_record(file), 2 * 3 * kScansInEntry);
  }
  EXPECT_EQ(test::content_of(folder / "a.h5"), finished);  // What was finished is not touched.
}

INSTANTIATE_TEST_SUITE_P(Errors, RefusedOnce, testing::Values(ENOSPC, EIO, EDQUOT, EFBIG, EROFS),
                         [](const auto& error) { return std::string{::strerrorname_np(error.param)}; });

// fsync(2): after an error the kernel may have dropped the pages; what was written since the last success is
// written again, not believed.
TEST(PatientJournal, WhatAnFsyncRefusedIsWrittenAgain) {
  class DroppingDisk final : public test::ForwardingCalls {
   public:
    int fdatasync(int file) const override {
      if (!drop) return 0;
      drop = false;
      // As a kernel that lost the pages: zeros where the entries stood.
      const off_t end = ::lseek(file, 0, SEEK_END);
      static_cast<void>(::ftruncate(file, synced));
      static_cast<void>(::ftruncate(file, end));
      errno = EIO;
      return -1;
    }
    int fsync(int) const override { return 0; }
    mutable bool drop = false;
    off_t synced = 0;
  };
  const TemporaryFolder folder;
  DroppingDisk disk;
  PatientJournal journal{folder / "a.journal", test::sample_header(), kMemory, disk};
  ASSERT_EQ(journal.save(), std::nullopt);
  disk.synced = static_cast<off_t>(fs::file_size(folder / "a.journal"));
  journal.add_scans(0, std::vector<double>(kScansInEntry, 0.0), {});
  disk.drop = true;
  EXPECT_NE(journal.save(), std::nullopt);
  EXPECT_EQ(journal.save(), std::nullopt);
  const auto read = record::read_journal(folder / "a.journal");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->why_unread(), "");
  expect_all(read->record, kScansInEntry);
}

TEST(PatientJournal, WhatDoesNotFitIntoTheMemoryIsAGapWithItsCause) {
  const TemporaryFolder folder;
  FaultyDisk disk;
  disk.refuse(ENOSPC);
  constexpr std::size_t kEntry = record::kEntryHeadSize + 2 * kScansInEntry;
  std::optional<PatientJournal> journal{std::in_place, folder / "a.journal", test::sample_header(),
                                        10 * kEntry, disk};
  const auto add = [&](std::int64_t entry) {
    const auto first = entry * static_cast<std::int64_t>(kScansInEntry);
    return journal->add_scans(first, std::vector<double>(kScansInEntry, 7.0), {});
  };
  for (int entry = 0; entry < 25; ++entry) {
    EXPECT_EQ(add(entry), entry < 10) << entry;
    EXPECT_NE(journal->save(), std::nullopt);
  }
  EXPECT_EQ(journal->lost_scan_count(), 15 * 35);
  disk.works_again();
  EXPECT_EQ(journal->save(), std::nullopt);
  EXPECT_TRUE(add(25));
  journal->add_end(sound_end());
  EXPECT_EQ(journal->save(), std::nullopt);

  journal.reset();  // Its lock too.
  const auto file = record::finalise(folder / "a.journal");
  ASSERT_TRUE(file);
  const record::Verdict verdict = record::judge(file->file);
  EXPECT_EQ(verdict.judgement, record::Judgement::kIncomplete);
  ASSERT_EQ(verdict.gaps.size(), 1U);
  EXPECT_EQ(verdict.gaps[0].first, 350);
  EXPECT_EQ(verdict.gaps[0].count, 15 * 35);
  EXPECT_EQ(verdict.gaps[0].cause, daq::GapCause::kStorageFull);
  const auto read = record::read_record(file->file);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->raw.size(), 11 * kScansInEntry);
  EXPECT_EQ(read->end->status, record::Status::kIncomplete);
  EXPECT_EQ(read->end->reasons,
            std::vector<std::string>{"525 scans could not be stored: the disk refused them"});
}

// A limit to the size of files is the kernel's own refusal: a write that is cut short, then EFBIG.
TEST(PatientJournal, GoesOnWhenARealLimitIsLifted) {
  const TemporaryFolder folder;
  PatientJournal journal{folder / "a.journal", test::sample_header(), kMemory};
  ASSERT_EQ(journal.save(), std::nullopt);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit tight{fs::file_size(folder / "a.journal") + 50, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &tight), 0);
  write_test(journal, 3);
  const auto refused = journal.save();
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, old_handler);
  ASSERT_TRUE(refused);
  EXPECT_THAT(*refused, testing::HasSubstr("File too large"));
  EXPECT_EQ(journal.save(), std::nullopt);
  expect_all(record::read_journal(folder / "a.journal")->record, 3 * 3 * kScansInEntry);
}

}  // namespace
}  // namespace stickslip
