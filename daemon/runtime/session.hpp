/// \file
/// One life of a board: from start() to the last scan, with its ring and its two threads.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/daq/latency_histogram.hpp"
#include "core/daq/scan_ring.hpp"
#include "core/pipeline/processor.hpp"
#include "daemon/runtime/acquisition.hpp"
#include "drivers/factory/factory.hpp"

namespace stickslip::runtime {

struct SessionSettings {
  pipeline::ProcessorSettings processor;
  daq::LoadCell load_cell;
  record::CalibrationFacts calibration;  ///< Of the load cell, for the records.
  std::string characterisation;  ///< Where processor.analysis.prior comes from, for the records; empty: none.
  io::RealtimeSettings realtime{0, {}, false};
  double clock_speed = 1.0;  ///< Board time over wall time: the ring bridges wall time.
  /// kWait needs a source that can wait, and so processor.clock_is_real = false.
  FullRing full_ring = FullRing::kDrop;
};

/// Where a session left the index, for the next one.
struct SessionEnd {
  std::int64_t next_test_number = 1;
  std::optional<daq::Continuation> continuation;  ///< None if there was no scan.
};

/// Called on the processing thread.
struct SessionEvents {
  std::function<void()> first_scan;
  std::function<void(Acquisition::End)> ended;  ///< All sinks have got everything.
  /// Each block as it was read, before anything is made of it; empty: nobody looks.
  std::function<void(const daq::ScanBlock&)> block;
};

/// What happens in all sessions of a program; readable from any thread at any time.
struct SessionCounts {
  std::atomic<std::uint64_t> scans{0};
  std::atomic<std::uint64_t> dropped_scans{0};  ///< By the ring.
  std::atomic<std::uint64_t> overruns{0};
  std::atomic<std::uint64_t> gaps{0};
  std::atomic<std::int64_t> lost_scans{0};  ///< In gaps.
  std::atomic<std::int64_t> idle_scans{0};  ///< That no test wanted.
};

/// A picture of what a session measures about itself.
struct SessionClocks {
  std::optional<daq::RateEstimate> scan_rate;  ///< Of all scans so far.
  daq::LatencyHistogram latency;
};

class Session {
 public:
  /// \param sinks,counts  outlive the session.
  /// \throws std::invalid_argument as daq::Calibration and analysis::TestAnalysis.
  Session(drivers::OpenedBoard board, const SessionSettings& settings, std::vector<pipeline::Sink*> sinks,
          SessionEvents events, SessionCounts& counts);
  /// Stops, lets all scans be processed, waits.
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Starts the acquisition. Once. Errors: those of the board; no event comes then.
  [[nodiscard]] base::Result<void> start();
  /// Starts the processing thread; from here on sinks and events are called. Once, after start().
  void start_processing();
  /// The board stops, the ring is drained, a running test ends; then comes events.ended.
  void request_stop() noexcept { acquisition_.request_stop(); }

  /// What runs on the processing thread between two blocks, as soon as it can.
  using Job = std::function<void(pipeline::Processor&)>;
  /// From any thread. \return false if it will never be called: the session is over, or too many wait. After
  /// the last scan jobs are still called, on a bench that is degraded.
  [[nodiscard]] bool post(Job job);

  [[nodiscard]] const daq::BoardInfo& board_info() const noexcept { return board_.board->info(); }
  /// Why the board ended; only after events.ended.
  [[nodiscard]] std::string board_error() const { return board_.board->last_error(); }
  [[nodiscard]] const std::string& scheduling() const noexcept { return acquisition_.scheduling(); }
  /// Phase, regime and latest cycle of the running test, as of the block processed last. From any thread.
  [[nodiscard]] detect::LiveState live() const {
    const std::lock_guard lock{live_mutex_};
    return live_;
  }
  /// From any thread.
  [[nodiscard]] pipeline::BenchTrouble bench_trouble() const noexcept {
    return bench_trouble_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] pipeline::BenchState bench() const noexcept { return bench_.load(std::memory_order_relaxed); }
  /// From any thread.
  [[nodiscard]] SessionClocks clocks() const {
    const std::lock_guard lock{live_mutex_};
    return clocks_;
  }
  /// From any thread: how full the ring is and was.
  [[nodiscard]] daq::ScanRing::Use ring_use() const noexcept { return ring_.use(); }
  /// From any thread: scans that the board has delivered.
  [[nodiscard]] std::uint64_t delivered_scan_count() const noexcept {
    return acquisition_.delivered_scan_count();
  }
  /// From any thread: indices that the board has given, of scans that it delivered or lost.
  [[nodiscard]] std::int64_t issued_index_count() const noexcept { return acquisition_.issued_index_count(); }
  /// Only after events.ended.
  [[nodiscard]] SessionEnd end() const;

 private:
  /// What the processor has counted so far.
  struct Progress {
    std::uint64_t gaps;
    std::int64_t lost_scans;
    std::int64_t idle_scans;
  };

  void process();
  /// Empties the ring, but of no more than it can hold: scans may come faster than they are processed, and
  /// commands must have their turn. \param blocks  room for some. \return whether it was empty at last.
  [[nodiscard]] bool process_waiting(std::vector<daq::ScanBlock>& blocks);
  /// After the last block.
  void finish(Acquisition::End ended);
  [[nodiscard]] Progress progress() const noexcept;
  void count_since(const Progress& before) noexcept;
  void process_block(const daq::ScanBlock& block);
  /// Of the jobs that were posted those that run_jobs() is to call.
  void take_jobs();
  void run_jobs();
  /// No more jobs after this.
  void close_jobs();

  drivers::OpenedBoard board_;
  SessionEvents events_;
  daq::ScanRing ring_;
  pipeline::Processor processor_;
  Acquisition acquisition_;
  SessionCounts& counts_;
  mutable std::mutex live_mutex_;  ///< Held for a copy; the acquisition thread has no part in it.
  detect::LiveState live_;
  std::atomic<pipeline::BenchState> bench_;
  std::atomic<pipeline::BenchTrouble> bench_trouble_ = pipeline::BenchTrouble::kNone;
  SessionClocks clocks_;
  std::uint64_t dropped_before_ = 0;
  std::uint64_t overruns_before_ = 0;
  std::int64_t lost_at_end_ = 0;
  FullRing full_ring_;
  std::mutex jobs_mutex_;
  std::deque<Job> jobs_;        ///< At most kMostJobs.
  std::deque<Job> taken_jobs_;  ///< Of the processing thread: what it runs next.
  bool jobs_closed_ = false;
  bool any_scan_ = false;
  bool continues_;  ///< After another session: the gap before the first scan is that of a missing board.
  std::thread thread_;
};

}  // namespace stickslip::runtime
