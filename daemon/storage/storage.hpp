/// \file
/// The storage thread: every test becomes a journal while it runs and a finished file at its end. It meets no
/// disk: that is the disk thread's (disk_writer.hpp) and the finisher's.
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
#include "daemon/storage/finisher.hpp"
#include "daemon/storage/recovery.hpp"
#include "daemon/storage/room.hpp"
#include "daemon/types/facts.hpp"
#include "daemon/types/storage_state.hpp"
#include "daemon/types/test_log.hpp"

namespace stickslip::storage {

struct StorageSettings {
  std::filesystem::path folder;  ///< Made if absent, before the first test.
  io::DatedFolders dated_folders = io::DatedFolders::kNone;
  const record::FileCalls* calls = &record::system_calls();
  std::chrono::milliseconds sync_period{1000};  ///< As that of DiskWriter.
};

/// The record sink. As a sink it is bound to the processing thread. What the disk does not take at once waits
/// in memory, ten minutes of scans at least; what does not fit is a gap with the cause storage-full.
class Storage final : public pipeline::Sink {
 public:
  /// \param finalise  called on the finisher's thread. \param tests,facts  outlive this object.
  /// What became of the record of a test.
  using Made = std::function<void(std::int64_t test, const base::Result<std::filesystem::path>& file)>;
  /// \param changed  called on the disk thread when it is otherwise with the disk; may not wait.
  /// \param made  called on the disk's or the finisher's thread; may not wait.
  Storage(StorageSettings settings, Finalise finalise, daemon::TestLog& tests, daemon::Facts& facts,
          std::function<void()> changed = {}, Made made = {});
  /// As stop().
  ~Storage() override;
  Storage(const Storage&) = delete;
  Storage& operator=(const Storage&) = delete;

  /// What the records of the coming tests say about board, tester and program.
  /// Only while no test can arrive: before a session starts.
  /// \param remarks  an event each, in every record.
  void use(record::RecordHeader header, const model::TruthSource* truth,
           std::vector<std::string> remarks = {});

  /// What the records of the coming tests say otherwise, of those that begin after this.
  /// On the processing thread, or while no test can arrive.
  void amend(const std::function<void(record::RecordHeader&)>& change);

  /// Told of each test that is over, with what its record begins and ends with and where that will stand.
  using EndTold = std::function<void(const record::RecordHeader&, const record::EndRecord&,
                                     const std::filesystem::path&)>;
  /// Only while no test can arrive. \param told  called on the storage thread; may not wait.
  void tell_ends(EndTold told) { end_told_ = std::move(told); }

  /// Writes all that was handed over, finalises, ends the thread. No sink calls afterwards.
  void stop();

  /// How it is with the disk. Any thread.
  [[nodiscard]] DiskState disk() const { return disk_.state(); }
  /// The same for people and for those who begin tests, at most a second old. Any thread.
  [[nodiscard]] daemon::StorageState state() const { return storage_state(disk_.state(), settings_.folder); }
  /// Times the processing thread had to wait. Any thread.
  [[nodiscard]] std::uint64_t stall_count() const noexcept { return queue_.stall_count(); }

  /// As that of DiskWriter. Any thread.
  [[nodiscard]] daq::LatencyHistogram commit_time() const { return disk_.commit_time(); }
  /// What became of the scans of tests that have ended. Any thread.
  [[nodiscard]] DiskWriter::ScanCounts scan_counts() const;
  /// Times that the storage thread, and the disk thread, have come round; at rest or not they do so each
  /// second. Any thread.
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
    std::shared_ptr<model::TrueForce> force;  ///< Null if nobody knows it.
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
  /// \param realtime_ns  when it happened.
  void note_event(daq::ScanIndex scan, std::int64_t realtime_ns, std::string text);
  /// The noise-free force of the scans that are in the journal.
  void append_force(model::TrueForce& force);
  /// For how long there is room, if that is too short for a test.
  [[nodiscard]] std::optional<double> little_room_s() const;
  void journal_ended(std::int64_t test, std::int64_t scans, const std::optional<std::string>& why_not);
  void record_made(std::int64_t test, const base::Result<std::filesystem::path>& file);
  /// \param scans  that were written to the journal.
  void journal_finalised(std::int64_t test, std::int64_t scans, const base::Result<record::Finalised>& made);
  void disk_changed(const DiskState& state);

  StorageSettings settings_;
  daemon::TestLog& tests_;
  daemon::Facts& facts_;
  std::shared_ptr<const record::RecordHeader> header_;  ///< Processing thread.
  std::vector<std::string> remarks_;                    ///< Processing thread.
  const model::TruthSource* truth_ = nullptr;           ///< Processing thread.
  daq::ScanIndex first_ = 0;                            ///< Processing thread.
  daq::ScanBlock collected_;                     ///< Processing thread: scans that the queue has not got yet.
  std::vector<detect::Cycle> collected_cycles_;  ///< Processing thread: to follow them.
  std::size_t collected_enough_ = 1;             ///< Processing thread: to hand them over.
  base::BoundedQueue<Message> queue_;

  EndTold end_told_;
  std::int64_t number_ = 0;
  record::RecordHeader begun_;         ///< Of the test that runs.
  std::filesystem::path latest_path_;  ///< Of a journal that need not be on the disk yet.
  DiskWriter::Journal journal_;
  std::vector<double> pending_;               ///< Consecutive scans not yet appended.
  std::vector<std::int32_t> pending_second_;  ///< Of the same scans; none without a second channel.
  daq::ScanIndex pending_first_ = 0;
  daq::ClockStamp pending_stamp_;
  std::vector<Stretch> recorded_;   ///< All of them.
  std::size_t pending_enough_ = 1;  ///< scans_in_entry().
  std::function<void()> changed_;
  Made made_;
  bool waits_ = false;  ///< Disk thread: as it was told last, as the next.
  std::string waits_for_;
  bool is_short_ = false;
  std::atomic<std::int64_t> damaged_scans_{0};  ///< Written by the finisher's thread.
  Finisher finisher_;                           ///< Outlives the disk thread, which hands over to it.
  DiskWriter disk_;
  std::atomic<std::uint64_t> rounds_{0};
  std::thread thread_;
};

}  // namespace stickslip::storage
