// The folder of the records, or a journal in it, vanishes while tests are recorded.

#include <gmock/gmock.h>

#include <condition_variable>
#include <fstream>
#include <mutex>
#include <thread>

#include "core/record/finaliser.hpp"
#include "core/record/journal.hpp"
#include "core/record/reader.hpp"
#include "daemon/storage/folder_watch.hpp"
#include "daemon/storage/storage.hpp"
#include "tests/support/faulty_disk.hpp"
#include "tests/support/moving_disk.hpp"
#include "tests/support/plain_finaliser.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::storage {
namespace {

using test::finalise_plainly;
using test::MovingDisk;
using test::TemporaryFolder;
namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// At once, also where another thread puts a file there meanwhile.
void take_away(const fs::path& folder) {
  const fs::path elsewhere = folder.native() + ".gone";
  fs::rename(folder, elsewhere);
  fs::remove_all(elsewhere);
}

constexpr int kOtherDevice = 1000;

/// Things that happen, in order, and a way to wait for them.
class Told final : public daemon::EventReceiver {
 public:
  void storage_waits(std::string_view why) override { add(std::string{why}); }
  void storage_resumed() override { add("resumed"); }
  void recording_failed(std::int64_t test, std::string_view why) override {
    add(fmt::format("test {} failed: {}", test, why));
  }
  void journal_written_anew(std::int64_t test, const fs::path& before, const fs::path& now) override {
    add(fmt::format("test {} anew: {} {}", test, before.filename().string(), now.filename().string()));
  }
  void file_published(std::int64_t test, const fs::path& file) override {
    add(fmt::format("test {}: {}", test, file.string()));
  }

  void add(std::string text) {
    const std::lock_guard lock{mutex_};
    told_.push_back(std::move(text));
    news_.notify_all();
  }
  /// \return the text that begins so.
  std::string wait_for(const std::string& start) {
    std::unique_lock lock{mutex_};
    const auto begins = [&](const std::string& text) { return text.starts_with(start); };
    news_.wait(lock, [&] { return std::any_of(told_.begin(), told_.end(), begins); });
    return *std::find_if(told_.begin(), told_.end(), begins);
  }
  [[nodiscard]] std::vector<std::string> all() {
    const std::lock_guard lock{mutex_};
    return told_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable news_;
  std::vector<std::string> told_;
};

// ---- the watch ----------------------------------------------------------------------------

class FolderWatched : public testing::Test {
 protected:
  FolderWatched() { fs::create_directories(records_); }

  const TemporaryFolder folder_;
  const fs::path records_ = folder_ / "disk" / "records";
  MovingDisk disk_;
};

TEST_F(FolderWatched, OneThatIsMissingOnItsOwnFileSystemMayBeMadeAgain) {
  FolderWatch watch{records_, disk_};
  EXPECT_FALSE(watch.look());
  take_away(folder_ / "disk");
  EXPECT_FALSE(watch.look());
}

TEST_F(FolderWatched, OneBelowAMountThatWentAwayMayNot) {
  disk_.mount(folder_ / "disk", kOtherDevice);
  FolderWatch watch{records_, disk_};
  EXPECT_FALSE(watch.look());
  disk_.unmount();
  const auto away = watch.look();
  ASSERT_TRUE(away);
  EXPECT_EQ(away->why, records_.string() + ": its file system is not mounted any more");
  EXPECT_EQ(away->to_do, fmt::format("mount the file system of {} again", records_.string()));
  take_away(folder_ / "disk");
  EXPECT_TRUE(watch.look());
  fs::create_directories(folder_ / "disk");
  EXPECT_TRUE(watch.look());
  disk_.mount(folder_ / "disk", kOtherDevice);
  EXPECT_FALSE(watch.look());
}

// A disk that was plugged out and in again has another number, and the remedy was followed.
TEST_F(FolderWatched, AnotherFileSystemThatIsMountedInItsPlaceIsAsGood) {
  disk_.mount(folder_ / "disk", kOtherDevice);
  FolderWatch watch{records_, disk_};
  disk_.mount(folder_ / "disk", kOtherDevice + 1);
  EXPECT_FALSE(watch.look());
  disk_.unmount();
  EXPECT_TRUE(watch.look());
}

TEST_F(FolderWatched, AFileSystemThatIsMountedLateIsAsGood) {
  FolderWatch watch{records_, disk_};
  disk_.mount(folder_ / "disk", kOtherDevice);
  EXPECT_FALSE(watch.look());
  disk_.unmount();
  EXPECT_TRUE(watch.look());
}

/// The roots of file systems of a kind have the same number.
class RootsOfOneNumber final : public test::ForwardingCalls {
 public:
  RootsOfOneNumber(const MovingDisk& disk, fs::path root) : disk_(disk), root_(std::move(root)) {}
  int lstat(const char* path, struct ::stat* found) const override {
    const int status = disk_.lstat(path, found);
    const fs::path looked_at = (fs::path{path} / "").lexically_normal();
    if (status == 0 && (looked_at == root_ / "" || looked_at == root_.parent_path() / "")) found->st_ino = 2;
    return status;
  }

 private:
  const MovingDisk& disk_;
  fs::path root_;
};

// The records stand in the root of a file system, which is mounted in the root of another one.
TEST_F(FolderWatched, ARootOnARootIsNotItsOwnParent) {
  const RootsOfOneNumber roots{disk_, folder_ / "disk"};
  disk_.mount(folder_ / "disk", kOtherDevice);
  FolderWatch watch{folder_ / "disk", roots};
  EXPECT_FALSE(watch.look());
  disk_.unmount();
  EXPECT_TRUE(watch.look());
}

TEST_F(FolderWatched, OneThatCannotBeLookedAtIsAway) {
  FolderWatch watch{records_, disk_};
  for (const int error : {EACCES, ESTALE, EIO, ENOTDIR}) {
    disk_.hide(folder_ / "disk", error);
    const auto away = watch.look();
    ASSERT_TRUE(away) << error;
    EXPECT_THAT(away->why, testing::HasSubstr(std::strerror(error)));
  }
  disk_.hide({}, 0);
  EXPECT_FALSE(watch.look());
  take_away(records_);
  std::ofstream{records_} << "a file";
  EXPECT_TRUE(watch.look());
}

// ---- the whole storage --------------------------------------------------------------------

class StorageAstray : public testing::Test {
 protected:
  StorageAstray() { fs::create_directories(records_); }

  void open(Finalise finalise = finalise_plainly) {
    record::RecordHeader header = test::sample_header();
    header.uuid.clear();
    header.board.second.reset();
    storage_.emplace(StorageSettings{.folder = records_, .calls = &disk_, .sync_period = 1ms},
                     std::move(finalise), tests_, told_);
    storage_->use(std::move(header), nullptr);
  }
  void begin(std::int64_t number) {
    storage_->test_began({number, next_, next_, {0, 1'795'265'582'000'000'000, true}, nullptr});
  }
  void feed(std::int64_t count) {
    storage_->scans(next_, std::vector<double>(static_cast<std::size_t>(count), 7.0), {}, {});
    next_ += count;
  }
  void end(std::int64_t number) {
    pipeline::TestEnd ended;
    ended.number = number;
    ended.end = next_;
    ended.results = record::absent_results("not analysed");
    storage_->test_ended(ended);
  }
  /// Once the journal that was begun holds scans: before that the disk thread may still be making it.
  fs::path journal() {
    for (;;) {
      for (const auto& entry : fs::directory_iterator{records_}) {
        if (entry.path().extension() != record::kJournalExtension) continue;
        const auto read = record::read_journal(entry.path());
        if (read && !read->record.scan.empty()) return entry.path();
      }
      std::this_thread::yield();
    }
  }
  [[nodiscard]] static std::size_t scans_in(const fs::path& folder) {
    std::size_t scans = 0;
    for (const auto& entry : fs::directory_iterator{folder}) {
      if (entry.path().extension() != record::kRecordExtension) continue;
      const auto read = record::read_record(entry.path());
      EXPECT_TRUE(read) << entry.path();
      if (read) scans += read->scan.size();
    }
    return scans;
  }
  void expect_all_recorded() {
    EXPECT_EQ(scans_in(records_), static_cast<std::size_t>(next_));
    EXPECT_EQ(storage_->scan_counts().recorded, next_);
    EXPECT_EQ(storage_->scan_counts().unsaved, 0);
  }

  const TemporaryFolder folder_;
  const fs::path records_ = folder_ / "disk" / "records";
  MovingDisk disk_;
  daemon::TestLog tests_;
  Told told_;
  std::optional<Storage> storage_;
  daq::ScanIndex next_ = 0;
};

TEST_F(StorageAstray, AJournalThatIsRemovedInMidTestIsToldAndWrittenAnew) {
  open();
  begin(1);
  feed(350);
  const fs::path was = journal();
  fs::remove(was);
  told_.wait_for("test 1 anew: ");
  feed(350);
  end(1);
  storage_->stop();
  expect_all_recorded();
}

TEST_F(StorageAstray, AFolderThatIsRemovedInMidTestIsMadeAgain) {
  open();
  begin(1);
  feed(350);
  static_cast<void>(journal());
  fs::rename(folder_ / "disk", folder_ / "elsewhere");
  told_.wait_for("test 1 anew: ");
  feed(350);
  end(1);
  storage_->stop();
  expect_all_recorded();
}

/// The folder is on a device of its own, until it is unmounted; the way up can be blocked.
class BlockedDisk final : public test::ForwardingCalls {
 public:
  int lstat(const char* path, struct ::stat* found) const override {
    const bool is_above = std::string_view{path}.find("..") != std::string_view::npos;
    if (is_above && blocked) {
      errno = ESTALE;
      return -1;
    }
    found->st_ino = is_above ? 1 : 2;
    found->st_dev = is_above || !mounted ? 1 : 2;
    return 0;
  }
  bool mounted = true;
  bool blocked = false;
};

// A file system that goes while its folder is looked at.
TEST(FolderWatch, KnowsWhatIsAboveTheFolderAlsoIfTheWayUpWasBlockedOnce) {
  BlockedDisk disk;
  FolderWatch watch{"records", disk};
  EXPECT_FALSE(watch.look());
  disk.blocked = true;
  EXPECT_FALSE(watch.look());
  disk.blocked = false;
  disk.mounted = false;
  const auto away = watch.look();
  ASSERT_TRUE(away);
  EXPECT_THAT(away->why, testing::EndsWith("not mounted any more"));
}

TEST_F(StorageAstray, NothingIsWrittenBelowAMountThatWentAway) {
  disk_.mount(folder_ / "disk", kOtherDevice);
  open();
  begin(1);
  feed(350);
  static_cast<void>(journal());
  // Its file system goes, with all that is on it; what lay below the mount point is seen.
  disk_.hide(folder_ / "disk", ESTALE);
  told_.wait_for("storage waiting: the folder of the records is away, ");
  fs::rename(folder_ / "disk", folder_ / "unmounted");
  fs::create_directories(records_);
  disk_.unmount();
  disk_.hide({}, 0);
  while (!storage_->state().why.ends_with("not mounted any more")) std::this_thread::yield();
  EXPECT_EQ(storage_->state().kind, daemon::StorageState::Kind::kWaiting);
  EXPECT_THAT(storage_->state().to_do, testing::StartsWith("mount the file system of "));
  feed(350);
  end(1);
  // Later tests do not go below the mount point either.
  begin(2);
  feed(350);
  end(2);
  while (storage_->state().waiting_size < 1400) std::this_thread::yield();
  EXPECT_TRUE(fs::is_empty(records_));
  EXPECT_EQ(storage_->scan_counts().recorded, 0);
  take_away(folder_ / "disk");
  fs::rename(folder_ / "unmounted", folder_ / "disk");
  disk_.mount(folder_ / "disk", kOtherDevice);
  told_.wait_for("resumed");
  told_.wait_for("test 2: ");
  storage_->stop();
  EXPECT_THAT(told_.all(), testing::Not(testing::Contains(testing::HasSubstr("anew"))));
  expect_all_recorded();
}

// While the finaliser waits, the journal is watched as before.
TEST_F(StorageAstray, AJournalThatVanishesBeforeItsRecordIsMadeComesBack) {
  std::atomic<bool> refuses{true};
  open([&](const fs::path& journal, ExpectedScans expected) -> base::Result<record::Finalised> {
    if (refuses) return base::failure("not yet");
    return finalise_plainly(journal, expected);
  });
  begin(1);
  feed(350);
  end(1);
  told_.wait_for("test 1 failed: not yet");
  take_away(folder_ / "disk");
  told_.wait_for("test 1 anew: ");
  refuses = false;
  storage_->stop();
  expect_all_recorded();
}

// ---- disk thread and finisher -------------------------------------------------------------

/// Does something when somebody looks at a file.
class WatchedDisk final : public test::ForwardingCalls {
 public:
  int lstat(const char* path, struct ::stat* found) const override {
    if (on_look) on_look(path);
    return ForwardingCalls::lstat(path, found);
  }
  int fsync(int) const override { return 0; }
  int fdatasync(int) const override { return 0; }

  std::function<void(const fs::path&)> on_look;
};

using Made = base::Result<record::Finalised>;

/// Two journals, a of a running test and b of one that ended.
class RecordsTakenAway : public testing::Test {
 protected:
  RecordsTakenAway() {
    disk_.on_look = [this](const fs::path& path) {
      if (path != folder_ / "a.journal") return;
      ++looks_;
      if (at_next_look_.exchange(false)) make_record();
    };
    const auto journal_at = [&](const char* name) {
      auto journal =
          std::make_shared<record::PatientJournal>(folder_ / name, test::sample_header(), 1 << 20, disk_);
      journal->add_scans(0, std::vector<double>(350, 7.0), {});
      return journal;
    };
    writer_.emplace(
        DiskWriter::Settings{.folder = folder_.path(),
                             .sync_period = 1ms,
                             .retry_period = 1ms,
                             .patience = 0ms,
                             .calls = &disk_},
        [this](std::int64_t, const fs::path&, std::int64_t, const std::optional<std::string>& why) {
          told_.add(why.value_or("ended"));
        },
        [](const DiskState&) {});
    writer_->begin(1, journal_at("a.journal"));
    over_ = journal_at("b.journal");
    writer_->begin(2, over_);
    writer_->end(over_);
    told_.wait_for("ended");
  }

  /// As the finaliser does; the record's reader takes the record away at once.
  void make_record(const std::function<void()>& then = [] {}) {
    const auto made = writer_->make_record(2, [&](const fs::path& journal) -> Made {
      fs::remove(journal);
      then();
      return record::Finalised{"b.h5", 350, 0, {}};
    });
    EXPECT_TRUE(made.has_value());
  }
  void wait_for_looks(int count) {
    for (const int before = looks_; looks_ < before + count;) std::this_thread::yield();
  }
  void expect_not_missed() {
    EXPECT_FALSE(fs::exists(folder_ / "b.journal"));
    EXPECT_EQ(over_->anew_count(), 0);
    EXPECT_FALSE(writer_->make_record(2, [](const fs::path&) -> Made { return base::failure("twice"); }));
    EXPECT_EQ(writer_->scan_counts().recorded, 350);
    writer_->stop();
  }

  const TemporaryFolder folder_;
  Told told_;
  WatchedDisk disk_;
  std::atomic<int> looks_{0};
  std::atomic<bool> at_next_look_{false};  ///< The disk thread itself is to make the record.
  std::shared_ptr<record::PatientJournal> over_;
  std::optional<DiskWriter> writer_;
};

TEST_F(RecordsTakenAway, WhileTheDiskThreadIsBusyWithAnotherJournal) {
  at_next_look_ = true;
  wait_for_looks(3);
  EXPECT_FALSE(at_next_look_);
  expect_not_missed();
}

TEST_F(RecordsTakenAway, BeforeTheFinaliserHasSaidThatItMadeThem) {
  make_record([this] { wait_for_looks(3); });
  wait_for_looks(3);
  expect_not_missed();
}

TEST(DiskWriterAstray, WhatIsGoneAtTheEndIsUnsaved) {
  const TemporaryFolder folder;
  MovingDisk moving;
  Told told;
  DiskWriter writer{{.folder = folder / "records",
                     .sync_period = 1ms,
                     .retry_period = 1ms,
                     .patience = 0ms,
                     .calls = &moving},
                    [&](std::int64_t, const fs::path&, std::int64_t, const std::optional<std::string>& why) {
                      told.add(why.value_or("ended"));
                    },
                    [&](const DiskState& state) { told.add(state.trouble.value_or("fine")); }};
  const auto journal = std::make_shared<record::PatientJournal>(folder / "records" / "a.journal",
                                                                test::sample_header(), 1 << 20, moving);
  journal->add_scans(0, std::vector<double>(350, 7.0), {});
  writer.begin(1, journal);
  writer.end(journal);
  told.wait_for("ended");
  const auto place = [&writer] {
    return writer.make_record(1, [](const fs::path& at) -> Made { return base::failure("{}", at.string()); })
        .error()
        .message;
  };
  EXPECT_EQ(place(), folder / "records" / "a.journal");
  EXPECT_EQ(writer.scan_counts().recorded, 350);
  moving.refuse_reads(EIO);
  fs::remove(folder / "records" / "a.journal");
  told.wait_for((folder / "records" / "a.journal").string() + ": is gone, and cannot be read back");
  EXPECT_THAT(place(), testing::HasSubstr("is gone, and cannot be read back"));
  EXPECT_EQ(writer.scan_counts().recorded, 0);
  EXPECT_EQ(writer.scan_counts().unsaved, 0);
  writer.stop();
  writer.close_account();
  EXPECT_EQ(writer.scan_counts().recorded, 0);
  EXPECT_EQ(writer.scan_counts().unsaved, 350);
}

TEST(DiskWriterAstray, OneJournalThatCannotBeWrittenHoldsUpNoOther) {
  const TemporaryFolder folder;
  MovingDisk disk;
  Told told;
  DiskWriter writer{
      {.folder = folder.path(), .sync_period = 1ms, .retry_period = 1ms, .patience = 0ms, .calls = &disk},
      [&](std::int64_t test, const fs::path&, std::int64_t, const std::optional<std::string>& why) {
        told.add(fmt::format("{} {}", test, why ? "refused" : "ended"));
      },
      [&](const DiskState& state) { told.add(state.trouble ? "waits" : "fine"); }};
  const auto journal = [&](const char* name) {
    return std::make_shared<record::PatientJournal>(folder / name / "x.journal", test::sample_header(),
                                                    1 << 20, disk);
  };
  const auto first = journal("a");
  const auto second = journal("b");
  writer.begin(1, first);
  while (!fs::exists(first->path())) std::this_thread::yield();
  disk.hide(folder / "a", EACCES);
  told.wait_for("waits");
  writer.begin(2, second);
  writer.end(first);
  writer.end(second);
  told.wait_for("2 ended");
  writer.stop();
  told.wait_for("1 refused");
}

TEST(FinisherAstray, WaitsForAJournalThatIsAwayAndFollowsItToItsNewName) {
  std::atomic<bool> away{true};
  Told told;
  Finisher finisher{[&](std::int64_t, std::int64_t scans) -> Made {
                      if (away) return base::failure("Stale file handle");
                      return record::Finalised{"a-2.journal made", scans, 0, {}};
                    },
                    [&](std::int64_t test, std::int64_t scans, const Made& made) {
                      told.add(made ? fmt::format("{}: {} of {} scans", test, made->file.string(), scans)
                                    : fmt::format("{}: {}", test, made.error().message));
                    },
                    1ms};
  finisher.finish(1, 350);
  told.wait_for("1: Stale file handle");
  away = false;
  told.wait_for("1: a-2.journal made of 350 scans");
  away = true;
  finisher.finish(2, 700);
  told.wait_for("2: Stale file handle");
  finisher.stop();
  EXPECT_THAT(told.all(), testing::ElementsAre("1: Stale file handle", "1: a-2.journal made of 350 scans",
                                               "2: Stale file handle"));
}

TEST(BallastAstray, IsTakenAgainWhereItWentWithItsFolder) {
  const TemporaryFolder folder;
  const test::FaultyDisk disk;
  fs::create_directory(folder / "records");
  Ballast ballast{folder / "records", disk};
  take_away(folder / "records");
  ballast.take();
  EXPECT_FALSE(fs::exists(folder / "records"));
  fs::create_directory(folder / "records");
  ballast.take();
  EXPECT_TRUE(fs::exists(folder / "records" / ".stickslip-ballast"));
  EXPECT_TRUE(ballast.give());
}

}  // namespace
}  // namespace stickslip::storage
