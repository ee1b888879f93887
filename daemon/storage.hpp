/// \file
/// The storage thread: every test becomes a journal while it runs and a finished file at its end.
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

#include "core/friction/truth.hpp"
#include "core/pipeline/sink.hpp"
#include "core/record/journal.hpp"
#include "core/record/record.hpp"
#include "daemon/bounded_queue.hpp"
#include "daemon/facts.hpp"
#include "daemon/test_log.hpp"

namespace stickslip::daemon {

/// Builds the finished file of a journal; called on the storage thread.
using Finalise = std::function<base::Result<std::filesystem::path>(const std::filesystem::path& journal)>;

/// The record sink. As a sink it is bound to the processing thread, which waits here when the
/// disk is slower than the board: the record loses nothing before the acquisition ring does.
class Storage final : public pipeline::Sink {
 public:
  /// \param folder  exists and is writable.
  /// \param tests,facts  outlive this object.
  Storage(std::filesystem::path folder, Finalise finalise, TestLog& tests, Facts& facts);
  /// As stop().
  ~Storage() override;
  Storage(const Storage&) = delete;
  Storage& operator=(const Storage&) = delete;

  /// What the records of the coming tests say about board, tester and program.
  /// Only while no test can arrive: before a session starts.
  void use(record::RecordHeader header, const friction::TruthSource* truth);

  /// Writes all that was handed over, finalises, ends the thread. No sink calls afterwards.
  void stop();

  /// Times the processing thread had to wait for the disk. Any thread.
  [[nodiscard]] std::uint64_t stall_count() const noexcept { return queue_.stall_count(); }

  void test_began(const pipeline::TestStart& start) override;
  void scans(daq::ScanIndex first, std::span<const double> raw, std::span<const std::int32_t> second,
             const daq::ClockStamp& stamp) override;
  void gap(const daq::Gap& gap) override;
  void anchor(const daq::ClockAnchor& anchor) override;
  void cycle(const friction::Cycle& cycle) override;
  void test_ended(const pipeline::TestEnd& end) override;

 private:
  struct Began {
    pipeline::TestStart start;
    std::shared_ptr<const record::RecordHeader> header;
  };
  struct Ended {
    std::shared_ptr<const record::EndRecord> end;
    std::shared_ptr<friction::TrueForce> force;  ///< Null if nobody knows it.
  };
  /// Consecutive scans in the journal.
  struct Stretch {
    daq::ScanIndex first;
    daq::ScanIndex end;
  };
  struct Quit {};
  using Message =
      std::variant<Quit, Began, daq::ScanBlock, daq::Gap, daq::ClockAnchor, friction::Cycle, Ended>;

  // The storage thread's side.
  void run();
  void handle(const Began& message);
  void handle(const daq::ScanBlock& block);
  void handle(const daq::Gap& gap);
  void handle(const daq::ClockAnchor& anchor);
  void handle(const friction::Cycle& cycle);
  void handle(const Ended& message);
  void append_pending();
  /// The noise-free force of the scans that are in the journal.
  [[nodiscard]] base::Result<void> append_force(friction::TrueForce& force);
  void sync_if_due();
  void note(const base::Result<void>& written);
  void fail(const std::string& why);

  std::filesystem::path folder_;
  Finalise finalise_;
  TestLog& tests_;
  Facts& facts_;
  std::shared_ptr<const record::RecordHeader> header_;  ///< Processing thread.
  const friction::TruthSource* truth_ = nullptr;        ///< Processing thread.
  daq::ScanIndex first_ = 0;                            ///< Processing thread.
  BoundedQueue<Message> queue_;

  std::int64_t number_ = 0;
  std::optional<record::JournalWriter> journal_;
  std::vector<double> pending_;               ///< Consecutive scans not yet appended.
  std::vector<std::int32_t> pending_second_;  ///< Of the same scans; none without a second channel.
  daq::ScanIndex pending_first_ = 0;
  daq::ClockStamp pending_stamp_;
  std::vector<Stretch> recorded_;   ///< All of them.
  std::size_t pending_enough_ = 1;  ///< Scans in one journal entry.
  std::optional<std::string> failed_;
  std::chrono::steady_clock::time_point last_sync_;
  std::thread thread_;
};

}  // namespace stickslip::daemon
