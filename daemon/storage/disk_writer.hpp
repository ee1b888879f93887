/// \file
/// The disk thread: writes the journals, syncs them once a second, and goes on when the disk does not.
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
#include "core/record/patient_journal.hpp"
#include "daemon/storage/folder_watch.hpp"

namespace stickslip::storage {

/// No test of the tester lasts longer.
inline constexpr double kLeastRoom_s = 600.0;
/// When there is room again, so that a disk at the limit does not change its state each second.
inline constexpr double kRoomAgain_s = 1.25 * kLeastRoom_s;

/// What a journal takes beside the scans, bytes/s: heads of ten entries, two clock readings and twenty cycles
/// as JSON of 400 bytes.
inline constexpr double kOtherBytesPerSecond = 9000.0;

/// How it is with the disk.
struct DiskState {
  std::optional<std::string> trouble;  ///< Why something waits in memory; nothing if all is written.
  std::string to_do;                   ///< Where the folder of the records is away: how it comes back.
  std::size_t waiting_size = 0;        ///< Bytes in memory then.
  /// For how long there is room at least, scanning all the time: whole hours, below one whole minutes.
  std::optional<double> room_h;
  bool is_short = false;  ///< Room for less than kLeastRoom_s, and since then for no more than kRoomAgain_s.

  bool operator==(const DiskState&) const = default;
};

/// Room on a full disk for what has been begun: a file that is given away when the first write is refused.
/// Gone with its owner.
class Ballast {
 public:
  /// \param folder  exists. \param calls  outlive it.
  Ballast(const std::filesystem::path& folder, const record::FileCalls& calls);
  ~Ballast();
  Ballast(const Ballast&) = delete;
  Ballast& operator=(const Ballast&) = delete;

  /// \return whether there was any to give.
  bool give();
  /// Takes it again where there is plenty of room.
  void take();

 private:
  std::filesystem::path path_;
  const record::FileCalls& calls_;
  bool kept_ = false;
};

class DiskWriter {
 public:
  struct Settings {
    std::filesystem::path folder;                 ///< Of the records.
    std::chrono::milliseconds sync_period{1000};  ///< At most this much is lost at a power cut.
    std::chrono::milliseconds retry_period{1000};
    std::chrono::milliseconds patience{30'000};  ///< With a disk that refuses, when all is to end.
    const record::FileCalls* calls = &record::system_calls();
    /// A journal had gone from `before` and was written anew. Called on the disk thread; may not wait.
    std::function<void(std::int64_t test, const std::filesystem::path& before,
                       const std::filesystem::path& now)>
        written_anew = {};
  };
  using Journal = std::shared_ptr<record::PatientJournal>;

  /// Of a test whose journal was ended, with its scans: it is durable, or why it could not be made so.
  using Ended = std::function<void(std::int64_t test, const std::filesystem::path& journal,
                                   std::int64_t scans, const std::optional<std::string>& why_not)>;

  /// \param ended  called on the disk thread. \param changed  called on the disk thread when state() has
  /// changed. Either may not wait.
  DiskWriter(Settings settings, Ended ended, std::function<void(const DiskState&)> changed);
  ~DiskWriter();
  DiskWriter(const DiskWriter&) = delete;
  DiskWriter& operator=(const DiskWriter&) = delete;

  // Any thread.

  /// Writes the journal from now on.
  void begin(std::int64_t test, Journal journal);
  /// Something was added to a journal.
  void wake();
  /// Nothing will be added to it any more. When it is durable it is told as ended, and watched until its
  /// record is made.
  void end(const Journal& journal);
  /// Where the journal of a test that has ended stands. Errors: kFailure where its path does not lead to it.
  [[nodiscard]] base::Result<std::filesystem::path> journal_of(std::int64_t test) const;
  /// The record of a test that has ended is made.
  void finished(std::int64_t test);
  /// Bytes that the disk takes in each second of a test: journal and record.
  void set_load(double bytes_per_s) { load_bytes_per_s_ = bytes_per_s; }
  [[nodiscard]] DiskState state() const;
  /// Bytes of all journals that are not on the disk yet.
  [[nodiscard]] std::size_t waiting_size() const;
  /// Times that the thread has come round: each second, unless a call of the disk does not return.
  [[nodiscard]] std::uint64_t rounds() const noexcept { return rounds_.load(std::memory_order_relaxed); }
  /// Scans of the journals that have ended. Those whose journal is not where it belongs are in none of them
  /// until it is there again, or all has ended.
  struct ScanCounts {
    std::int64_t recorded = 0;  ///< Durable, in records or in journals that wait to become one.
    std::int64_t lost = 0;      ///< Gaps for want of memory, in the same journals.
    std::int64_t damaged = 0;   ///< Durable once, and not to be read when the record was made.
    std::int64_t unsaved = 0;   ///< Of journals that the disk refused, or that were gone, to the end.
  };
  [[nodiscard]] ScanCounts scan_counts() const;
  /// How long it took, each time, to write and sync what a journal held; what the disk refused is not in it.
  [[nodiscard]] daq::LatencyHistogram commit_time() const;
  /// For how long there is room now; nothing if nobody knows.
  [[nodiscard]] std::optional<double> room_s() const;

  /// Writes what can be written, ends the thread. What the disk refuses for too long is told as ended with a
  /// reason.
  void stop();
  /// After stop(), when no more records are made: journals that are not where they belong are looked for once
  /// more, and their scans counted as unsaved if they are gone.
  void close_account();

 private:
  struct Job {
    std::int64_t test;
    Journal journal;
    bool ended = false;
    bool handed_over = false;  ///< Its record is being made.
    std::optional<std::string> trouble = {};
  };
  using Clock = std::chrono::steady_clock;
  using Time = Clock::time_point;

  void run();
  /// Writes all jobs, in order. \return why not.
  [[nodiscard]] std::optional<std::string> write_all(bool sync);
  [[nodiscard]] std::optional<std::string> write(const Job& job, bool sync);
  void hand_over(const Job& job);
  void tell(std::optional<std::string> trouble);
  void give_up(const std::string& why);

  Settings settings_;
  Ended ended_;
  std::function<void(const DiskState&)> changed_;
  std::atomic<double> load_bytes_per_s_{0.0};
  FolderWatch folder_watch_;
  std::optional<FolderWatch::Away> away_;  ///< Disk thread.
  Ballast ballast_;

  mutable std::mutex mutex_;
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
