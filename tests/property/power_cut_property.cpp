// The power is cut at any moment: after every change of a file, with what was not synced there, missing or
// mixed. What was synced is there after recovery, what was published stays whole, and nothing stops the next
// start.
//
// STICKSLIP_POWER_CUTS=N makes N states of every moment, else some moments are taken by chance; figures in
// docs/reliability-evidence.md. The seed is printed and may be given as STICKSLIP_SEED.

#include <gmock/gmock.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <numeric>
#include <optional>
#include <set>

#include "core/record/finaliser.hpp"
#include "core/record/journal.hpp"
#include "core/record/journal_care.hpp"
#include "core/record/journal_entries.hpp"
#include "core/record/patient_journal.hpp"
#include "core/record/reader.hpp"
#include "core/record/verdict.hpp"
#include "tests/support/crash_disk.hpp"
#include "tests/support/sanitized.hpp"

namespace stickslip {
namespace {

using record::Judgement;
using test::CrashDisk;
using test::HastyCalls;
using test::TemporaryFolder;
namespace fs = std::filesystem;

/// From a moment of the log on: at least so many scans, and of a finished test all of them in a record.
struct Promise {
  std::size_t after;
  std::size_t scans;
  bool finished;
};

std::uint64_t seed() {
  const char* const given = std::getenv("STICKSLIP_SEED");
  const std::uint64_t seed = given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
  std::printf("STICKSLIP_SEED=%llu\n", static_cast<unsigned long long>(seed));
  return seed;
}

/// States to try of each moment, each moment; nothing: a few moments by chance, as in continuous integration.
std::optional<int> states_of_each_moment() {
  const char* const given = std::getenv("STICKSLIP_POWER_CUTS");
  if (given == nullptr) return std::nullopt;
  return std::atoi(given);
}
constexpr std::size_t kMomentsByChance = test::kSanitized ? 5 : 20;

constexpr std::size_t kScansInEntry = 35;

/// As the storage thread writes a test: entries, a sync now and then, cycles between them.
std::vector<Promise> write_test(const CrashDisk& disk, const fs::path& journal, bool with_end) {
  std::vector<Promise> promises{{disk.promise(), 0, false}};
  record::RecordHeader header = test::sample_header();
  header.process.configuration.assign(6000, '#');  // Longer than a page: a header can be torn.
  auto writer = record::JournalWriter::create(journal, header, disk);
  EXPECT_TRUE(writer);
  daq::ScanIndex next = 0;
  for (int second = 0; second < 6; ++second) {
    for (int entry = 0; entry < 4; ++entry) {
      const std::vector<double> raw(kScansInEntry, 1000.0 + static_cast<double>(next));
      EXPECT_TRUE(writer->append_scans(next, raw, {next, next}));
      next += static_cast<daq::ScanIndex>(kScansInEntry);
      if (entry == 1) {
        EXPECT_TRUE(writer->append_cycle(test::sample_cycles().front()));
      }
    }
    EXPECT_TRUE(writer->sync());
    promises.push_back({disk.promise(), static_cast<std::size_t>(next), false});
  }
  if (with_end) {
    record::EndRecord end = test::sample_end();
    end.status = record::Status::kComplete;
    end.reasons.clear();
    end.spikes.clear();
    EXPECT_TRUE(writer->append_end(end));
    EXPECT_TRUE(writer->sync());
    promises.push_back({disk.promise(), static_cast<std::size_t>(next), false});
  }
  return promises;
}

bool has_complete_entry(const fs::path& journal) {
  auto entries = record::JournalEntries::open(journal);
  return entries && entries->next().has_value();
}

/// What the next start does. \return the scans in a row that it has then.
std::size_t recover(const fs::path& journal, const fs::path& file, const record::FileCalls& calls,
                    std::size_t moment) {
  if (fs::exists(journal)) {
    const auto removed = record::remove_if_empty(journal);
    EXPECT_TRUE(removed) << moment;
    if (removed && !*removed) {
      // A header of which only some pages were written cannot be told from a damaged one: it stays.
      const bool stays = !has_complete_entry(journal);
      const auto finished = record::finalise(journal, {}, calls);
      EXPECT_EQ(finished.has_value(), !stays) << moment << ": " << (finished ? "" : finished.error().message);
      if (stays) return 0;
    }
  }
  EXPECT_FALSE(fs::exists(journal)) << moment;
  if (!fs::exists(file)) return 0;
  const record::Verdict verdict = record::judge(file);
  EXPECT_NE(verdict.judgement, Judgement::kDamaged)
      << moment << ": " << (verdict.findings.empty() ? "" : verdict.findings.back().text);
  // Each value is the first scan of its entry and thousand. Scans behind a page that did not get to the disk
  // are worth having, but nobody promised them.
  const auto read = record::read_record(file);
  EXPECT_TRUE(read) << moment;
  std::size_t in_a_row = 0;
  for (std::size_t i = 0; read && i < read->raw.size(); ++i) {
    const auto scan = static_cast<std::size_t>(read->scan[i]);
    EXPECT_GE(scan, i);
    EXPECT_EQ(read->raw[i], 1000.0 + static_cast<double>(scan - scan % kScansInEntry)) << moment;
    in_a_row += scan == i ? 1 : 0;
  }
  return in_a_row;
}

/// The moments to cut at, of a log of so many changes: all of them, or exactly so many by chance.
std::vector<std::size_t> moments_to_cut_at(std::size_t changes, bool all, std::mt19937_64& random) {
  std::vector<std::size_t> moments(changes + 1);
  std::iota(moments.begin(), moments.end(), std::size_t{0});
  if (all) return moments;
  std::vector<std::size_t> some;
  std::ranges::sample(moments, std::back_inserter(some), kMomentsByChance, random);
  return some;
}

/// Cuts at the moments of the log. \return states tried.
int cut_everywhere(const CrashDisk& disk, const std::vector<Promise>& promises, std::uint64_t seed) {
  std::mt19937_64 random{seed};
  int tried = 0;
  const std::optional<int> states = states_of_each_moment();
  for (const std::size_t cut : moments_to_cut_at(disk.size(), states.has_value(), random)) {
    Promise due{0, 0, false};
    for (const Promise& promise : promises) {
      if (promise.after <= cut) due = promise;
    }
    for (int state = states.value_or(1); state > 0; --state) {
      const TemporaryFolder folder;
      disk.restore(cut, random, folder.path());
      if (due.finished) {
        EXPECT_TRUE(fs::exists(folder / "a.h5")) << cut;
      }
      const std::size_t scans = recover(folder / "a.journal", folder / "a.h5", HastyCalls{}, cut);
      EXPECT_GE(scans, due.scans) << "after " << cut << " of " << disk.size() << " changes";
      if (testing::Test::HasFailure()) return tried;
      ++tried;
    }
  }
  std::printf("%d states of %zu moments\n", tried, disk.size() + 1);
  return tried;
}

TEST(PowerCut, WhileATestIsWrittenAndFinished) {
  const TemporaryFolder folder;
  const CrashDisk disk;
  auto promises = write_test(disk, folder / "a.journal", true);
  ASSERT_TRUE(record::finalise(folder / "a.journal", {}, disk));
  promises.push_back({disk.promise(), promises.back().scans, true});
  ASSERT_GT(disk.size(), 40U);
  EXPECT_GT(cut_everywhere(disk, promises, seed()), 0);
}

// Where a name is given in two steps: a cut between them leaves both names, or an empty file of the new one.
TEST(PowerCut, WhereARenameCannotRefuseToReplace) {
  for (const bool knows_link : {true, false}) {
    const TemporaryFolder folder;
    CrashDisk disk;
    disk.knows_rename_to_new = false;
    disk.knows_link = knows_link;
    auto promises = write_test(disk, folder / "a.journal", true);
    const std::size_t before = disk.promise();
    ASSERT_TRUE(record::finalise(folder / "a.journal", {}, disk));
    promises.push_back({disk.promise(), promises.back().scans, true});
    EXPECT_GT(cut_everywhere(disk, promises, seed()), 0);
    // The steps themselves stand at the end: each of them, some states each.
    std::mt19937_64 random{seed()};
    for (std::size_t cut = std::max(before, disk.size() - 8); cut <= disk.size(); ++cut) {
      for (int state = 0; state < 3; ++state) {
        const TemporaryFolder restored;
        disk.restore(cut, random, restored.path());
        EXPECT_EQ(recover(restored / "a.journal", restored / "a.h5", HastyCalls{}, cut),
                  promises.back().scans);
      }
    }
  }
}

TEST(PowerCut, WhileAnInterruptedTestIsRecovered) {
  const TemporaryFolder folder;
  const CrashDisk disk;
  auto promises = write_test(disk, folder / "a.journal", false);
  // The recovery after it; its own power cuts are those of the second half of the log.
  ASSERT_TRUE(record::finalise(folder / "a.journal", {}, disk));
  promises.push_back({disk.promise(), promises.back().scans, true});
  EXPECT_GT(cut_everywhere(disk, promises, seed()), 0);
}

/// A disk that refuses some calls and takes them the next time: of each kind the ones of these numbers, from
/// 0. Of refused writes in a row the first has written half; of a refused sync nobody knows what is on the
/// disk.
class Faltering final : public test::ForwardingCalls {
 public:
  Faltering(const CrashDisk& disk, std::set<int> writes, std::set<int> syncs)
      : disk_(disk), refused_writes_(std::move(writes)), refused_syncs_(std::move(syncs)) {}
  int open(const char* path, int flags, mode_t mode) const override { return disk_.open(path, flags, mode); }
  ssize_t write(int file, const void* bytes, std::size_t size) const override {
    const int number = writes_++;
    if (!refused_writes_.contains(number)) return disk_.write(file, bytes, size);
    if (!refused_writes_.contains(number - 1) && size > 1) return disk_.write(file, bytes, size / 2);
    errno = ENOSPC;
    return -1;
  }
  int ftruncate(int file, off_t size) const override { return disk_.ftruncate(file, size); }
  int reserve(int, off_t, off_t) const override { return 0; }
  int fsync(int file) const override { return disk_.fsync(file); }
  int fdatasync(int file) const override {
    if (!refused_syncs_.contains(syncs_++)) return disk_.fdatasync(file);
    errno = EIO;
    return -1;
  }
  int unlink(const char* path) const override { return disk_.unlink(path); }

 private:
  const CrashDisk& disk_;
  std::set<int> refused_writes_;
  std::set<int> refused_syncs_;
  mutable int writes_ = 0;
  mutable int syncs_ = 0;
};

/// As storage thread and disk thread do it: entries into memory, written as they come, synced once a second.
/// \param calls  of the journal; what they do ends in the log of the disk.
std::vector<Promise> write_patiently(const CrashDisk& disk, const record::FileCalls& calls,
                                     const fs::path& path) {
  std::vector<Promise> promises{{disk.promise(), 0, false}};
  record::RecordHeader header = test::sample_header();
  header.board.second.reset();
  header.process.configuration.assign(6000, '#');
  constexpr std::size_t kPlenty = std::size_t{1} << 20U;
  record::PatientJournal journal{path, header, kPlenty, calls};
  daq::ScanIndex next = 0;
  // What waits is written until the disk has taken it.
  const auto save = [&] {
    while (journal.save()) {
    }
    promises.push_back({disk.promise(), static_cast<std::size_t>(next), false});
  };
  for (int second = 0; second < 6; ++second) {
    for (int entry = 0; entry < 4; ++entry) {
      const std::vector<double> raw(kScansInEntry, 1000.0 + static_cast<double>(next));
      EXPECT_TRUE(journal.add_scans(next, raw, {next, next}));
      next += static_cast<daq::ScanIndex>(kScansInEntry);
      if (entry == 1) {
        EXPECT_TRUE(journal.add_cycle(test::sample_cycles().front()));
      }
      static_cast<void>(journal.write());
    }
    save();
  }
  record::EndRecord end = test::sample_end();
  end.status = record::Status::kComplete;
  end.reasons.clear();
  end.spikes.clear();
  journal.add_end(std::move(end));
  save();
  return promises;
}

TEST(PowerCut, WhileAPatientJournalIsWrittenAndFinished) {
  const TemporaryFolder folder;
  const CrashDisk disk;
  auto promises = write_patiently(disk, disk, folder / "a.journal");
  ASSERT_TRUE(record::finalise(folder / "a.journal", {}, disk));
  promises.push_back({disk.promise(), promises.back().scans, true});
  EXPECT_GT(cut_everywhere(disk, promises, seed()), 0);
}

// The way of a refused sync: back to the last good one, and all of it once more.
TEST(PowerCut, WhileAPatientJournalIsRefusedAndTriesAgain) {
  const TemporaryFolder folder;
  const CrashDisk disk;
  const Faltering calls{disk, {3, 4, 9, 10, 11, 17, 18}, {1, 3, 4}};
  auto promises = write_patiently(disk, calls, folder / "a.journal");
  ASSERT_TRUE(record::finalise(folder / "a.journal", {}, disk));
  promises.push_back({disk.promise(), promises.back().scans, true});
  EXPECT_GT(cut_everywhere(disk, promises, seed()), 0);
}

// The proof can fail: with an fsync left out, scans are missed.
class Forgetful final : public test::ForwardingCalls {
 public:
  Forgetful(const CrashDisk& disk, bool files, bool folders)
      : disk_(disk), files_(files), folders_(folders) {}
  int open(const char* path, int flags, mode_t mode) const override {
    const int file = disk_.open(path, flags, mode);
    is_folder_[file] = fs::is_directory(path);
    return file;
  }
  ssize_t write(int file, const void* bytes, std::size_t size) const override {
    return disk_.write(file, bytes, size);
  }
  ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t position) const override {
    return disk_.pwrite(file, bytes, size, position);
  }
  int ftruncate(int file, off_t size) const override { return disk_.ftruncate(file, size); }
  int reserve(int, off_t, off_t) const override { return 0; }
  int fsync(int file) const override {
    return (is_folder_[file] ? folders_ : files_) ? disk_.fsync(file) : 0;
  }
  int fdatasync(int file) const override { return files_ ? disk_.fdatasync(file) : 0; }
  int rename_to_new(const char* from, const char* to) const override { return disk_.rename_to_new(from, to); }
  int unlink(const char* path) const override { return disk_.unlink(path); }

 private:
  const CrashDisk& disk_;
  bool files_;
  bool folders_;
  mutable std::map<int, bool> is_folder_;
};

/// Whether any state of the disk after a test was finished lacks its record or its scans.
bool loses_a_finished_test(bool sync_files, bool sync_folders) {
  const TemporaryFolder folder;
  const CrashDisk disk;
  const Forgetful calls{disk, sync_files, sync_folders};
  {
    auto writer = record::JournalWriter::create(folder / "a.journal", test::sample_header(), calls);
    EXPECT_TRUE(writer->append_scans(0, std::vector<double>(kScansInEntry, 1000.0), {}));
    EXPECT_TRUE(writer->sync());
  }
  EXPECT_TRUE(record::finalise(folder / "a.journal", {}, calls));
  std::mt19937_64 random{1};
  for (int state = 0; state < 40; ++state) {
    const TemporaryFolder restored;
    disk.restore(disk.size(), random, restored.path());
    if (!fs::exists(restored / "a.h5") || record::judge(restored / "a.h5").judgement == Judgement::kDamaged)
      return true;
  }
  return false;
}

TEST(PowerCut, EachKindOfSyncIsNeeded) {
  EXPECT_FALSE(loses_a_finished_test(true, true));
  EXPECT_TRUE(loses_a_finished_test(false, true));
  EXPECT_TRUE(loses_a_finished_test(true, false));
}

}  // namespace
}  // namespace stickslip
