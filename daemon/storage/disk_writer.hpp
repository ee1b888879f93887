/// \file
/// The disk thread: writes the journals, syncs them once a second, and retries while the disk refuses. No
/// other thread waits for it.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "core/base/result.hpp"
#include "core/daq/latency_histogram.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/patient_journal.hpp"
#include "daemon/storage/folder_watch.hpp"

namespace stickslip::storage {

/// The disk is short of room below this time of scanning. It exceeds the longest test of the tester.
inline constexpr double kLeastRoom_s = 600.0;
/// The disk is no longer short above this time of scanning. The hysteresis keeps a disk at the limit from
/// changing its state each second.
inline constexpr double kRoomAgain_s = 1.25 * kLeastRoom_s;

/// Size of a journal beside its scans, bytes/s: in each second heads of ten entries, two clock readings, and
/// twenty cycles as JSON of 400 bytes.
inline constexpr double kOtherBytesPerSecond = 9000.0;

/// State of the disk.
struct DiskState {
  std::optional<std::string> trouble;  ///< Why entries wait in memory; absent: all is written.
  std::string to_do;                   ///< Remedy if the record folder is away; else empty.
  std::size_t waiting_size = 0;        ///< Bytes that wait in memory while there is trouble.
  /// Hours of continuous scanning that the disk has room for, rounded down to hours, below 1 h to minutes.
  /// Absent: unknown.
  std::optional<double> room_h;
  /// True below room for kLeastRoom_s, until there is room for kRoomAgain_s.
  bool is_short = false;

  bool operator==(const DiskState&) const = default;
};

/// Reserve of disk space for a running test: a preallocated file, deleted when a write is refused. The
/// destructor deletes it too.
class Ballast {
 public:
  /// Calls take(). \param folder  must exist. \param calls  outlive this object.
  Ballast(const std::filesystem::path& folder, const record::FileCalls& calls);
  ~Ballast();
  Ballast(const Ballast&) = delete;
  Ballast& operator=(const Ballast&) = delete;

  /// Deletes the file. \return true if that freed room.
  bool give();
  /// Makes the file again if the disk has room for four of it.
  void take();

 private:
  std::filesystem::path path_;
  const record::FileCalls& calls_;
  bool kept_ = false;
};

class DiskWriter {
 public:
  struct Settings {
    std::filesystem::path folder;  ///< The record folder.
    /// Time between two syncs: a power cut loses at most this much.
    std::chrono::milliseconds sync_period{1000};
    std::chrono::milliseconds retry_period{1000};
    /// Time for which stop() retries on a disk that refuses.
    std::chrono::milliseconds patience{30'000};
    const record::FileCalls* calls = &record::system_calls();
    /// Called on the disk thread when a journal was missing at `before` and was written again, at `now`. It
    /// must not block.
    std::function<void(std::int64_t test, const std::filesystem::path& before,
                       const std::filesystem::path& now)>
        written_anew = {};
  };
  using Journal = std::shared_ptr<record::PatientJournal>;

  /// Called when the journal of an ended test is durable (`why_not` is absent) or was given up (`why_not` is
  /// the reason). \param scans  number of scans in the journal.
  using Ended = std::function<void(std::int64_t test, const std::filesystem::path& journal,
                                   std::int64_t scans, const std::optional<std::string>& why_not)>;

  /// Starts the disk thread. \param ended  called on the disk thread. \param changed  called on the disk
  /// thread when state() has changed. Neither may block.
  DiskWriter(Settings settings, Ended ended, std::function<void(const DiskState&)> changed);
  /// As stop().
  ~DiskWriter();
  DiskWriter(const DiskWriter&) = delete;
  DiskWriter& operator=(const DiskWriter&) = delete;

  // The following may be called from any thread. Only stop() and room_s() may block on the disk.

  /// Writes the journal of a test from now on.
  void begin(std::int64_t test, Journal journal);
  /// Wakes the thread: entries were added to a journal.
  void wake();
  /// States that the journal is complete. The disk thread makes it durable, calls `ended`, and writes it
  /// again if it vanishes before make_record().
  void end(const Journal& journal);
  /// Makes the record of an ended test; its journal is no longer watched. While `make` runs the journal is
  /// not looked for, as making a record removes it. \param make  called with the path of the journal; blocks
  /// no other journal. Errors: those of `make`; kFailure if the journal is not at its path, or has its
  /// record.
  base::Result<record::Finalised> make_record(
      std::int64_t test,
      const std::function<base::Result<record::Finalised>(const std::filesystem::path& journal)>& make);
  /// Sets the growth of journal and record together, bytes in each second of scanning.
  void set_load(double bytes_per_s) { load_bytes_per_s_ = bytes_per_s; }
  [[nodiscard]] DiskState state() const;
  /// Bytes of all journals that are not written yet.
  [[nodiscard]] std::size_t waiting_size() const;
  /// Loops of the thread so far: at least one each second, unless a system call hangs.
  [[nodiscard]] std::uint64_t rounds() const noexcept { return rounds_.load(std::memory_order_relaxed); }
  /// Scans of ended journals. While a journal is missing at its path its scans are in none of the counts;
  /// close_account() settles them.
  struct ScanCounts {
    std::int64_t recorded = 0;  ///< Durable, in records or in journals that are not records yet.
    std::int64_t lost = 0;      ///< Lost because memory was full; recorded as gaps.
    /// Durable in a journal, but unreadable when the record was made; always 0 here, Storage counts them.
    std::int64_t damaged = 0;
    /// Never written: in journals that the disk refused, or that were missing, to the end.
    std::int64_t unsaved = 0;
  };
  [[nodiscard]] ScanCounts scan_counts() const;
  /// Times to write and sync the new entries of a journal. Failed attempts are not counted.
  [[nodiscard]] daq::LatencyHistogram commit_time() const;
  /// Seconds of continuous scanning that the disk has room for now; nothing if unknown.
  [[nodiscard]] std::optional<double> room_s() const;

  /// Writes all journals and ends the thread; blocks, at most for Settings::patience if the disk refuses.
  /// Journals still unwritten then are given up: `ended` is called with the reason.
  void stop();
  /// Settles scan_counts() after stop(), when no more records are made: looks once more for journals without
  /// a record; scans of missing ones count as unsaved, others as recorded.
  void close_account();

 private:
  struct Job {
    std::int64_t test;
    Journal journal;
    bool ended = false;
    bool handed_over = false;  ///< `ended` was called; its record is being made.
    std::optional<std::string> trouble = {};
    /// Held while its record is made, and while it is looked for.
    std::shared_ptr<std::mutex> claim = std::make_shared<std::mutex>();
  };
  using Clock = std::chrono::steady_clock;
  using Time = Clock::time_point;

  void run();
  /// Writes the journals of all jobs, in order. \return why one could not be written, if so.
  [[nodiscard]] std::optional<std::string> write_all(bool sync);
  [[nodiscard]] std::optional<std::string> write(const Job& job, bool sync);
  void hand_over(const Job& job);
  void finished(std::int64_t test);
  void tell(std::optional<std::string> trouble);
  void give_up(const std::string& why);

  Settings settings_;
  Ended ended_;
  std::function<void(const DiskState&)> changed_;
  std::atomic<double> load_bytes_per_s_{0.0};
  FolderWatch folder_watch_;
  std::optional<FolderWatch::Away> away_;  ///< Disk thread only.
  Ballast ballast_;

  mutable std::mutex mutex_;  ///< Held while that of PatientJournal is taken, never taken while that is held.
  std::condition_variable woken_;
  std::list<Job> jobs_;
  bool has_news_ = false;
  bool stopping_ = false;
  DiskState state_;
  ScanCounts scans_;
  daq::LatencyHistogram commit_time_;
  std::atomic<std::uint64_t> rounds_{0};
  std::thread thread_;
};

}  // namespace stickslip::storage
