// The storage thread on a disk that is full, fails or takes its time: what was handed over is there in the
// end, or is a gap with its cause.

#include "daemon/storage/storage.hpp"

#include <gmock/gmock.h>

#include <condition_variable>
#include <mutex>

#include "core/record/finaliser.hpp"
#include "core/record/reader.hpp"
#include "core/record/verdict.hpp"
#include "daemon/storage/finaliser_process.hpp"
#include "tests/support/faulty_disk.hpp"
#include "tests/support/lacking_disk.hpp"
#include "tests/support/plain_finaliser.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::storage {
namespace {

using test::FaultyDisk;
using test::finalise_plainly;
using test::TemporaryFolder;
namespace fs = std::filesystem;

constexpr double kRate_Hz = 350.0;
constexpr std::int64_t kTenMinutes = 600 * 350;

/// What was told, and a way to wait for it.
class Heard final : public daemon::EventReceiver {
 public:
  void storage_waits(std::string_view why) override { add("waits: " + std::string{why}); }
  void storage_resumed() override { add("resumed"); }
  void storage_short(std::string_view why) override { add(std::string{why}); }
  void storage_has_room() override { add("has room"); }
  void little_room(std::int64_t test, double room_s) override {
    add(fmt::format("test {} has room for {:.0f} s", test, room_s));
  }
  void recording_failed(std::int64_t test, std::string_view why) override {
    add(fmt::format("test {} failed: {}", test, why));
  }
  void record_damaged(const fs::path& /*file*/, std::string_view loss) override {
    add("damaged: " + std::string{loss});
  }
  void file_published(std::int64_t test, const fs::path& file) override {
    {
      const std::lock_guard lock{mutex_};
      files_[test] = file;
    }
    add(fmt::format("test {} published", test));
  }

  void wait_for(const std::string& start) {
    std::unique_lock lock{mutex_};
    news_.wait(lock, [&] {
      return std::any_of(told_.begin(), told_.end(),
                         [&](const std::string& text) { return text.starts_with(start); });
    });
  }
  [[nodiscard]] fs::path file(std::int64_t test) {
    const std::lock_guard lock{mutex_};
    return files_[test];
  }
  [[nodiscard]] std::vector<std::string> told() {
    const std::lock_guard lock{mutex_};
    return told_;
  }

 private:
  void add(std::string text) {
    const std::lock_guard lock{mutex_};
    told_.push_back(std::move(text));
    news_.notify_all();
  }
  std::mutex mutex_;
  std::condition_variable news_;
  std::vector<std::string> told_;
  std::map<std::int64_t, fs::path> files_;
};

record::RecordHeader header() {
  record::RecordHeader header = test::sample_header();
  header.uuid.clear();
  header.board.second.reset();
  header.board.scan_rate_granted_Hz = kRate_Hz;
  return header;
}

void begin(Storage& storage, std::int64_t number, daq::ScanIndex first) {
  storage.test_began({number, first, first, {0, 1'795'265'582'000'000'000, true}, nullptr});
}

void feed(Storage& storage, daq::ScanIndex first, std::int64_t count) {
  std::vector<double> raw(350);
  for (std::int64_t done = 0; done < count; done += 350) {
    for (std::size_t i = 0; i < raw.size(); ++i) raw[i] = static_cast<double>((first + done) % 60000);
    storage.scans(first + done, raw, {}, {});
  }
}

void end(Storage& storage, std::int64_t number, daq::ScanIndex end) {
  pipeline::TestEnd ended;
  ended.number = number;
  ended.end = end;
  ended.results = record::absent_results("not analysed");
  storage.test_ended(ended);
}

void expect_whole(const fs::path& file, daq::ScanIndex first, std::int64_t count) {
  const record::Verdict verdict = record::judge(file);
  EXPECT_EQ(verdict.judgement, record::Judgement::kComplete)
      << file << (verdict.findings.empty() ? "" : verdict.findings.front().text);
  const auto read = record::read_record(file);
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->scan.size(), static_cast<std::size_t>(count));
  EXPECT_EQ(read->scan.front(), first);
  for (std::int64_t i = 0; i < count; i += 97) {
    const auto row = static_cast<std::size_t>(i);
    ASSERT_EQ(read->raw[row], static_cast<double>((first + i - i % 350) % 60000));
  }
}

// NFS without a lock manager, FUSE and SMB without fsync of folders, no rename that refuses to replace.
TEST(LackingFileSystem, IsNoDiskThatRefuses) {
  for (const int folder_fsync : {EINVAL, EOPNOTSUPP, EBADF, ENOSYS}) {
    const TemporaryFolder folder;
    test::LackingDisk disk;
    disk.flock_error = ENOLCK;
    disk.folder_fsync_error = folder_fsync;
    disk.rename_to_new_error = EINVAL;
    disk.link_error = EPERM;
    disk.tells_room = false;
    daemon::TestLog tests;
    Heard heard;
    {
      const auto finalise = [&](const fs::path& journal, ExpectedScans expected) {
        return record::finalise(journal, {}, disk, {}, expected);
      };
      Storage storage{{folder / "records", io::DatedFolders::kMonth, &disk}, finalise, tests, heard};
      storage.use(header(), nullptr);
      begin(storage, 1, 0);
      feed(storage, 0, 3500);
      end(storage, 1, 3500);
      storage.stop();
      EXPECT_EQ(storage.scan_counts().recorded, 3500);
      EXPECT_EQ(storage.scan_counts().unsaved, 0);
    }
    EXPECT_THAT(heard.told(), testing::ElementsAre("test 1 published"));
    expect_whole(heard.file(1), 0, 3500);
  }
}

class RefusingDisk : public testing::TestWithParam<int> {};

TEST_P(RefusingDisk, TenMinutesOfScansWaitInMemoryAndNothingIsLost) {
  const TemporaryFolder folder;
  FaultyDisk disk;
  daemon::TestLog tests;
  Heard heard;
  Storage storage{{folder / "records", io::DatedFolders::kMonth, &disk}, finalise_plainly, tests, heard};
  storage.use(header(), nullptr);
  disk.refuse(GetParam());
  begin(storage, 1, 0);
  feed(storage, 0, kTenMinutes);
  heard.wait_for("waits: ");
  EXPECT_THAT(*storage.disk().trouble, testing::HasSubstr(std::strerror(GetParam())));
  // A test ends and another begins meanwhile.
  end(storage, 1, kTenMinutes);
  begin(storage, 2, kTenMinutes + 700);
  disk.works_again();
  heard.wait_for("resumed");
  EXPECT_EQ(storage.disk().trouble, std::nullopt);
  feed(storage, kTenMinutes + 700, 3500);
  end(storage, 2, kTenMinutes + 4200);
  storage.stop();
  EXPECT_EQ(heard.file(1).parent_path(), folder / "records" / "2026" / "11");
  expect_whole(heard.file(1), 0, kTenMinutes);
  expect_whole(heard.file(2), kTenMinutes + 700, 3500);
}

INSTANTIATE_TEST_SUITE_P(Errors, RefusingDisk, testing::Values(ENOSPC, EIO, EDQUOT, EFBIG, EROFS),
                         [](const auto& error) { return std::string{::strerrorname_np(error.param)}; });

TEST(Storage, RemarksAreEventsOfEveryRecord) {
  const TemporaryFolder folder;
  FaultyDisk disk;
  daemon::TestLog tests;
  Heard heard;
  Storage storage{{folder.path(), io::DatedFolders::kNone, &disk}, finalise_plainly, tests, heard};
  storage.use(header(), nullptr, {"sampling: frequency not verifiable"});
  for (const std::int64_t number : {1, 2}) {
    begin(storage, number, 700 * number);
    feed(storage, 700 * number, 350);
    end(storage, number, 700 * number + 350);
  }
  storage.stop();
  for (const std::int64_t number : {1, 2}) {
    const auto read = record::read_record(heard.file(number));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_THAT(read->events, testing::Contains(testing::Field(&record::Event::text,
                                                               "sampling: frequency not verifiable")));
  }
}

// The date is set back by an hour in mid-test: the test has lasted as long as its scans say.
TEST(Storage, ATestEndsByItsScansWhateverTheDateIs) {
  const TemporaryFolder folder;
  FaultyDisk disk;
  daemon::TestLog tests;
  Heard heard;
  Storage storage{{folder.path(), io::DatedFolders::kNone, &disk}, finalise_plainly, tests, heard};
  storage.use(header(), nullptr);
  begin(storage, 1, 700);
  constexpr std::int64_t kStart_ns = 1'795'265'582'000'000'000;
  constexpr std::int64_t kHour_ns = 3'600'000'000'000;
  const std::vector<double> raw(350);
  storage.scans(700, raw, {}, {1'000'000'000, kStart_ns + 1'000'000'000, true});
  storage.scans(1050, raw, {}, {2'000'000'000, kStart_ns + 2'000'000'000 - kHour_ns, true});
  end(storage, 1, 1400);
  storage.stop();
  const auto read = record::read_record(heard.file(1));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->header.start_realtime_ns, kStart_ns);
  EXPECT_EQ(read->end->end_realtime_ns, kStart_ns + 2'000'000'000);
}

TEST(Storage, ADiskThatTakesItsTimeHoldsNobodyUp) {
  const TemporaryFolder folder;
  std::mutex gate;
  FaultyDisk disk;
  disk.hold([&gate] { const std::lock_guard wait{gate}; });
  daemon::TestLog tests;
  Heard heard;
  Storage storage{{folder.path(), io::DatedFolders::kDay, &disk}, finalise_plainly, tests, heard};
  storage.use(header(), nullptr);
  {
    // No write returns while the gate is shut.
    const std::lock_guard shut{gate};
    begin(storage, 1, 0);
    feed(storage, 0, kTenMinutes);
    end(storage, 1, kTenMinutes);
  }
  storage.stop();
  EXPECT_EQ(heard.file(1).parent_path(), folder / "2026-11-21");
  expect_whole(heard.file(1), 0, kTenMinutes);
}

// Each call of this disk takes a millisecond, and no commit is without a call.
TEST(Storage, ToldHowLongTheDiskTakes) {
  using Clock = std::chrono::steady_clock;
  const TemporaryFolder folder;
  FaultyDisk disk;
  disk.hold([] {
    for (const auto until = Clock::now() + std::chrono::milliseconds{1}; Clock::now() < until;) {
    }
  });
  daemon::TestLog tests;
  Heard heard;
  Storage storage{{folder.path(), io::DatedFolders::kNone, &disk}, finalise_plainly, tests, heard};
  storage.use(header(), nullptr);
  begin(storage, 1, 0);
  feed(storage, 0, 3500);
  end(storage, 1, 3500);
  storage.stop();
  const daq::LatencyHistogram took = storage.commit_time();
  EXPECT_GE(took.largest_s(), 1e-3);
  std::uint64_t commits = 0;
  for (std::size_t bin = 0; bin < daq::LatencyHistogram::kBins; ++bin) {
    commits += took.counts()[bin];
    if (daq::LatencyHistogram::limit_s(bin) <= 1e-3) {
      EXPECT_EQ(took.counts()[bin], 0U) << bin;
    }
  }
  EXPECT_GE(commits, 1U);
}

TEST(Storage, WhatDoesNotFitIsAGapAndTheTestGoesOn) {
  const TemporaryFolder folder;
  FaultyDisk disk;
  daemon::TestLog tests;
  Heard heard;
  Storage storage{{folder.path(), io::DatedFolders::kNone, &disk}, finalise_plainly, tests, heard};
  storage.use(header(), nullptr);
  disk.refuse(ENOSPC);
  begin(storage, 1, 0);
  // The memory is sized with room for cycles and the like, which there are none of here: hours of scans fill
  // it.
  feed(storage, 0, 12 * kTenMinutes);
  heard.wait_for("waits: ");
  disk.works_again();
  heard.wait_for("resumed");
  feed(storage, 12 * kTenMinutes, 3500);
  end(storage, 1, 12 * kTenMinutes + 3500);
  storage.stop();
  const record::Verdict verdict = record::judge(heard.file(1));
  EXPECT_EQ(verdict.judgement, record::Judgement::kIncomplete);
  ASSERT_EQ(verdict.gaps.size(), 1U);
  EXPECT_EQ(verdict.gaps[0].cause, daq::GapCause::kStorageFull);
  EXPECT_GE(verdict.gaps[0].first, kTenMinutes);
  EXPECT_EQ(*verdict.scans_present + verdict.gaps[0].count, 12 * kTenMinutes + 3500);
}

TEST(Storage, LittleRoomIsToldBeforeATestBegins) {
  const TemporaryFolder folder;
  FaultyDisk disk;
  disk.set_room(1'000'000);
  daemon::TestLog tests;
  Heard heard;
  Storage storage{{folder.path(), io::DatedFolders::kNone, &disk}, finalise_plainly, tests, heard};
  storage.use(header(), nullptr);
  begin(storage, 1, 0);
  end(storage, 1, 0);
  storage.stop();
  // 350 scans of 2 + 2 + 21 bytes and 9000 bytes of everything else in a second.
  EXPECT_THAT(heard.told(), testing::Contains("test 1 has room for 56 s"));
  const auto read = record::read_record(heard.file(1));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_THAT(read->events, testing::Contains(testing::Field(
                                &record::Event::text, "storage short: room on the disk for 56 s of tests")));
}

TEST(Storage, TellsThatItIsShortUntilThereIsRoomToSpare) {
  const TemporaryFolder folder;
  FaultyDisk disk;
  daemon::TestLog tests;
  Heard heard;
  Storage storage{{folder.path(), io::DatedFolders::kNone, &disk, std::chrono::milliseconds{1}},
                  finalise_plainly,
                  tests,
                  heard};
  EXPECT_EQ(storage.state().kind, daemon::StorageState::Kind::kOk);
  storage.use(header(), nullptr);
  constexpr double kLoad_per_s = 350.0 * 25.0 + 9000.0;
  const auto set_room_s = [&disk](double room_s) {
    disk.set_room(static_cast<std::int64_t>(room_s * kLoad_per_s));
  };
  set_room_s(599.0);
  heard.wait_for("storage short: room for 9 min of tests, 10 are wanted; move records from ");
  const daemon::StorageState little = storage.state();
  EXPECT_EQ(little.kind, daemon::StorageState::Kind::kShort);
  EXPECT_EQ(little.room_h, 9.0 / 60.0);
  EXPECT_THAT(daemon::why_no_test(little).value(), testing::HasSubstr(folder.path().string()));
  // A test that the force begins is recorded all the same.
  begin(storage, 1, 0);
  feed(storage, 0, 3500);
  end(storage, 1, 3500);
  heard.wait_for("test 1 published");
  set_room_s(7300.0);
  heard.wait_for("has room");
  EXPECT_EQ(storage.state().kind, daemon::StorageState::Kind::kOk);
  EXPECT_EQ(storage.state().room_h, 2.0);
  EXPECT_EQ(daemon::why_no_test(storage.state()), std::nullopt);
  storage.stop();
  expect_whole(heard.file(1), 0, 3500);
}

// A disk at the limit does not change its state each second.
TEST(DiskWriter, IsShortUntilThereIsRoomToSpare) {
  const TemporaryFolder folder;
  FaultyDisk disk;
  disk.set_room(599'000);
  std::mutex mutex;
  std::condition_variable told;
  std::optional<DiskState> latest;
  DiskWriter writer{{.folder = folder.path(), .sync_period = std::chrono::milliseconds{1}, .calls = &disk},
                    [](std::int64_t, const fs::path&, std::int64_t, const std::optional<std::string>&) {},
                    [&](const DiskState& state) {
                      const std::lock_guard lock{mutex};
                      latest = state;
                      told.notify_all();
                    }};
  writer.set_load(1000.0);
  const auto is_short_with_room_min = [&](double room_min) {
    std::unique_lock lock{mutex};
    told.wait(lock, [&] { return latest && latest->room_h == room_min * 60.0 / 3600.0; });
    return latest->is_short;
  };
  EXPECT_TRUE(is_short_with_room_min(9.0));
  disk.set_room(720'000);
  EXPECT_TRUE(is_short_with_room_min(12.0));
  disk.set_room(780'000);
  EXPECT_FALSE(is_short_with_room_min(13.0));
  disk.set_room(610'000);
  EXPECT_FALSE(is_short_with_room_min(10.0));
  disk.set_room(590'000);
  EXPECT_TRUE(is_short_with_room_min(9.0));
}

TEST(StorageState, SaysWhyAndWhatToDo) {
  DiskState disk;
  disk.room_h = 0.2;
  disk.is_short = true;
  EXPECT_EQ(storage::storage_state(disk, "records").why, "room for 12 min of tests, 10 are wanted");
  disk.trouble = "No space left on device";
  disk.waiting_size = 123'456;
  const daemon::StorageState waiting = storage::storage_state(disk, "records");
  EXPECT_EQ(waiting.kind, daemon::StorageState::Kind::kWaiting);
  EXPECT_EQ(waiting.waiting_size, 123'456U);
  EXPECT_EQ(daemon::why_no_test(waiting).value().substr(0, 82),
            "storage waiting: the disk refuses, 123 kB wait in memory: No space left on device;");
  disk.trouble = "records: its file system is not mounted any more";
  disk.to_do = "mount the file system of records again";
  EXPECT_EQ(
      daemon::why_no_test(storage::storage_state(disk, "records")),
      "storage waiting: the folder of the records is away, 123 kB wait in memory: records: its file system "
      "is "
      "not mounted any more; mount the file system of records again; memory holds ten minutes of scans, and "
      "they are written as soon as it is back");
}

TEST(Storage, ARecordThatCouldNotBeMadeIsTriedAgain) {
  const TemporaryFolder folder;
  daemon::TestLog tests;
  Heard heard;
  std::atomic<int> tries{0};
  const auto finalise = [&tries](const fs::path& journal, ExpectedScans) -> base::Result<record::Finalised> {
    if (tries++ == 0) return base::failure("no room for the record");
    return record::finalise(journal);
  };
  Storage storage{{folder.path()}, finalise, tests, heard};
  storage.use(header(), nullptr);
  begin(storage, 1, 0);
  feed(storage, 0, 3500);
  end(storage, 1, 3500);
  heard.wait_for("test 1 failed: no room for the record");
  storage.stop();
  expect_whole(heard.file(1), 0, 3500);
}

// The journal was durable; what the disk gives back is less.
TEST(Storage, ScansThatAreInNoRecordAreNotCountedAsRecorded) {
  const TemporaryFolder folder;
  daemon::TestLog tests;
  Heard heard;
  const auto finalise = [](const fs::path& journal, ExpectedScans expected) {
    std::string content = test::content_of(journal);
    std::fill_n(content.end() - static_cast<std::ptrdiff_t>(content.size() / 2), 512, '\0');
    test::write_content(journal, content);
    return finalise_plainly(journal, expected);
  };
  Storage storage{{folder.path()}, finalise, tests, heard};
  storage.use(header(), nullptr);
  begin(storage, 1, 0);
  feed(storage, 0, 3500);
  end(storage, 1, 3500);
  heard.wait_for("damaged: ");
  storage.stop();
  const auto read = record::read_record(heard.file(1));
  ASSERT_TRUE(read) << read.error().message;
  const DiskWriter::ScanCounts counts = storage.scan_counts();
  EXPECT_EQ(counts.recorded, static_cast<std::int64_t>(read->scan.size()));
  EXPECT_EQ(counts.damaged, 3500 - counts.recorded);
  EXPECT_GT(counts.damaged, 0);
}

TEST(Storage, ADiskThatStaysFullLetsTheDaemonEnd) {
  const TemporaryFolder folder;
  FaultyDisk disk;
  disk.refuse(ENOSPC);
  std::vector<std::string> ended;
  DiskWriter writer{
      {.folder = folder.path(), .patience = std::chrono::milliseconds{0}, .calls = &disk},
      [&](std::int64_t test, const fs::path&, std::int64_t, const std::optional<std::string>& why) {
        ended.push_back(fmt::format("{}: {}", test, why.value_or("written")));
      },
      [](const DiskState&) {}};
  const auto journal =
      std::make_shared<record::PatientJournal>(folder / "a.journal", test::sample_header(), 1000, disk);
  writer.begin(1, journal);
  writer.end(journal);
  writer.stop();
  ASSERT_EQ(ended.size(), 1U);
  EXPECT_THAT(ended[0], testing::HasSubstr("1: "));
  EXPECT_THAT(ended[0], testing::HasSubstr("No space left on device"));
}

// A disk that is full for real: what the ballast held is used for what was begun.
TEST(Ballast, IsGivenWhenTheDiskRefusesAndTakenAgain) {
  const TemporaryFolder folder;
  FaultyDisk disk;
  {
    Ballast ballast{folder.path(), disk};
    EXPECT_TRUE(fs::exists(folder / ".stickslip-ballast"));
    EXPECT_TRUE(ballast.give());
    EXPECT_FALSE(ballast.give());
    EXPECT_FALSE(fs::exists(folder / ".stickslip-ballast"));
    disk.set_room(10'000'000);
    ballast.take();
    EXPECT_FALSE(fs::exists(folder / ".stickslip-ballast"));
    disk.set_room(100'000'000);
    ballast.take();
    EXPECT_TRUE(fs::exists(folder / ".stickslip-ballast"));
  }
  EXPECT_FALSE(fs::exists(folder / ".stickslip-ballast"));
}

TEST(Ballast, FollowsNoLinkAndTakesTheNameOfOneThatAKillLeft) {
  const TemporaryFolder folder;
  std::ofstream{folder / "precious"} << "mine";
  fs::create_symlink("precious", folder / ".stickslip-ballast");
  {
    const Ballast killed{folder.path(), record::system_calls()};
    EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(folder / ".stickslip-ballast")));
    std::ofstream{folder / "left"} << "x";
    fs::rename(folder / "left", folder / ".stickslip-ballast");
    const Ballast next{folder.path(), record::system_calls()};
    EXPECT_EQ(fs::file_size(folder / ".stickslip-ballast"), 0U) << "room, and nothing of what was left";
  }
  EXPECT_EQ(fs::file_size(folder / "precious"), 4U);
}

}  // namespace
}  // namespace stickslip::storage
