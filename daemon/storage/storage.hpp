/// \file
/// Storage of tests: each test is written to a journal while it runs and becomes a record at its end. The
/// storage thread builds journal entries in memory; the disk thread (disk_writer.hpp) and the finisher's
/// thread do all disk access.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "io/dated_folders.hpp"

#include "core/base/bounded_queue.hpp"
#include "core/model/truth.hpp"
#include "core/pipeline/sink.hpp"
#include "core/record/record.hpp"
#include "daemon/storage/disk_writer.hpp"
#include "daemon/storage/finaliser_thread.hpp"
#include "daemon/storage/recovery.hpp"
#include "daemon/storage/storage_verdict.hpp"
#include "daemon/types/event_receiver.hpp"
#include "daemon/types/storage_state.hpp"
#include "daemon/types/test_log.hpp"

namespace stickslip::storage {

struct StorageSettings {
  /// The record folder. It is made if it is absent when a journal is first written.
  std::filesystem::path folder;
  io::DatedFolders dated_folders = io::DatedFolders::kNone;
  const record::FileCalls* calls = &record::system_calls();
  std::chrono::milliseconds sync_period{1000};  ///< As DiskWriter::Settings::sync_period.
};

/// The sink that records tests. Its sink functions are called on the processing thread; they block only while
/// the queue to the storage thread is full. While the disk refuses, entries wait in memory, at least ten
/// minutes of scans; scans beyond that become a gap with the cause storage-full.
class Storage final : public pipeline::Sink {
 public:
  /// Called with the record of a test, or why it could not be made.
  using Made = std::function<void(std::int64_t test, const base::Result<std::filesystem::path>& file)>;
  /// Starts the threads. \param finalise  called on the finisher's thread. \param tests,events  outlive this
  /// object. \param changed  called on the disk thread when disk() has changed; must not block. \param made
  /// called on the disk thread or the finisher's thread; must not block.
  Storage(StorageSettings settings, Finalise finalise, daemon::TestLog& tests, daemon::EventReceiver& events,
          std::function<void()> changed = {}, Made made = {});
  /// As stop().
  ~Storage() override;
  Storage(const Storage&) = delete;
  Storage& operator=(const Storage&) = delete;

  /// Sets the header of coming records: board, tester, program. Call it only while no test can arrive, before
  /// a session starts. \param truth  null if the truth is unknown. \param remarks  each becomes an event in
  /// every record.
  void use(record::RecordHeader header, const model::TruthSource* truth,
           std::vector<std::string> remarks = {});

  /// Changes the header of tests that begin later. Call it on the processing thread, or while no test can
  /// arrive.
  void amend(const std::function<void(record::RecordHeader&)>& change);

  /// Called when a test has ended, with the header and end of its record and the future path of the record.
  using EndTold = std::function<void(const record::RecordHeader&, const record::EndRecord&,
                                     const std::filesystem::path&)>;
  /// Sets the receiver of ends. Call it only while no test can arrive. \param told  called on the storage
  /// thread; must not block.
  void tell_ends(EndTold told) { end_told_ = std::move(told); }

  /// Writes all tests, makes their records, ends the threads; blocks. Call no sink function afterwards.
  void stop();

  /// State of the disk. Any thread.
  [[nodiscard]] DiskState disk() const { return disk_.state(); }
  /// State of the storage, with reason and remedy for people. At most a second old. Any thread.
  [[nodiscard]] daemon::StorageState state() const { return storage_state(disk_.state(), settings_.folder); }
  /// Times that the processing thread had to wait for room in the queue. Any thread.
  [[nodiscard]] std::uint64_t stall_count() const noexcept { return queue_.stall_count(); }

  /// As DiskWriter::commit_time(). Any thread.
  [[nodiscard]] daq::LatencyHistogram commit_time() const { return disk_.commit_time(); }
  /// Scan counts of ended tests. Any thread.
  [[nodiscard]] DiskWriter::ScanCounts scan_counts() const;
  /// Loops of the storage thread and of the disk thread so far: at least one each second, also at rest. Any
  /// thread.
  [[nodiscard]] std::uint64_t storage_rounds() const noexcept {
    return rounds_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] std::uint64_t disk_rounds() const noexcept { return disk_.rounds(); }

  void test_began(const pipeline::TestStart& start) override;
  void scans(daq::ScanIndex first, std::span<const double> raw, std::span<const std::int32_t> second,
             const daq::ClockStamp& stamp) override;
  void gap(const daq::Gap& gap) override;
  void anchor(const daq::ClockAnchor& anchor) override;
  void cycle(const detect::Cycle& cycle) override;
  void note(const daq::Note& note) override;
  void test_ended(const pipeline::TestEnd& end) override;

 private:
  struct Began {
    pipeline::TestStart start;
    std::shared_ptr<const record::RecordHeader> header;
    std::vector<std::string> remarks;
  };
  struct Ended {
    std::shared_ptr<const record::EndRecord> end;
    std::shared_ptr<model::TrueForce> force;  ///< Null if unknown.
  };
  /// Consecutive scans in the journal.
  struct Stretch {
    daq::ScanIndex first;
    daq::ScanIndex end;
  };
  struct Quit {};
  using Message =
      std::variant<Quit, Began, daq::ScanBlock, daq::Gap, daq::ClockAnchor, detect::Cycle, daq::Note, Ended>;

  // The processing thread's side.
  void hand_over_collected();

  // The storage thread's side.
  void run();
  void handle(const Began& message);
  void handle(const daq::ScanBlock& block);
  void handle(const daq::Gap& gap);
  void handle(const daq::ClockAnchor& anchor);
  void handle(const detect::Cycle& cycle);
  void handle(const daq::Note& note);
  void handle(const Ended& message);
  void append_pending();
  /// \param realtime_ns  nanoseconds since 1970.
  void note_event(daq::ScanIndex scan, std::int64_t realtime_ns, std::string text);
  /// The noise-free force of the scans that are in the journal.
  void append_force(model::TrueForce& force);
  /// Seconds of scanning that the disk has room for, if below kLeastRoom_s; else nothing.
  [[nodiscard]] std::optional<double> little_room_s() const;
  void journal_ended(std::int64_t test, std::int64_t scans, const std::optional<std::string>& why_not);
  void record_made(std::int64_t test, const base::Result<std::filesystem::path>& file);
  /// \param scans  number of scans written to the journal.
  void journal_finalised(std::int64_t test, std::int64_t scans, const base::Result<record::Finalised>& made);
  void disk_changed(const DiskState& state);

  StorageSettings settings_;
  daemon::TestLog& tests_;
  daemon::EventReceiver& events_;
  std::shared_ptr<const record::RecordHeader> header_;  ///< Processing thread.
  std::vector<std::string> remarks_;                    ///< Processing thread.
  const model::TruthSource* truth_ = nullptr;           ///< Processing thread.
  daq::ScanIndex first_ = 0;                            ///< Processing thread.
  daq::ScanBlock collected_;                            ///< Processing thread: scans not yet in the queue.
  std::vector<detect::Cycle> collected_cycles_;  ///< Processing thread: cycles that follow these scans.
  std::size_t collected_enough_ = 1;  ///< Processing thread: number of scans at which they are queued.
  base::BoundedQueue<Message> queue_;

  EndTold end_told_;
  std::int64_t number_ = 0;
  record::RecordHeader begun_;         ///< Header of the running test's record.
  std::filesystem::path latest_path_;  ///< Path of the latest journal, which may not exist yet.
  DiskWriter::Journal journal_;
  std::vector<double> pending_;               ///< Consecutive scans not yet appended.
  std::vector<std::int32_t> pending_second_;  ///< Of the same scans; none without a second channel.
  daq::ScanIndex pending_first_ = 0;
  daq::ClockStamp pending_stamp_;
  std::vector<Stretch> recorded_;   ///< All stretches of the running test.
  std::size_t pending_enough_ = 1;  ///< scans_in_entry().
  std::function<void()> changed_;
  Made made_;
  bool waits_ = false;  ///< Disk thread: state reported last, with the next two.
  std::string waits_for_;
  bool is_short_ = false;
  std::atomic<std::int64_t> damaged_scans_{0};  ///< Written by the finisher's thread.
  Finisher finisher_;                           ///< Outlives the disk thread, which hands over to it.
  DiskWriter disk_;
  std::atomic<std::uint64_t> rounds_{0};
  std::thread thread_;
};

}  // namespace stickslip::storage
