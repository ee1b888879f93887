/// \file
/// A session: one acquisition from an open board, from start() to the last scan, with ring, acquisition
/// thread and processing thread.
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
  /// Text of the characterisation that gave processor.analysis.prior, for the records; empty: none.
  std::string characterisation;
  io::RealtimeSettings realtime{0, {}, false};
  double clock_speed = 1.0;  ///< Board time over wall time; sets the size of the ring.
  /// kWait needs a source that can wait, hence processor.clock_is_real = false.
  FullRing full_ring = FullRing::kDrop;
};

/// Where a session ended; the next one continues there.
struct SessionEnd {
  std::int64_t next_test_number = 1;
  daq::Predecessor before;
};

/// Receivers of a session's events, called on the processing thread.
struct SessionEvents {
  std::function<void()> first_scan;
  std::function<void(Acquisition::End)> ended;  ///< Called last, after all calls of the sinks.
  /// Called with each block as it was read, before it is processed; may be empty.
  std::function<void(const daq::ScanBlock&)> block;
};

/// Counts over all sessions of a program. Readable from any thread at any time.
struct SessionCounts {
  std::atomic<std::uint64_t> scans{0};
  std::atomic<std::uint64_t> dropped_scans{0};  ///< Dropped because the ring was full.
  std::atomic<std::uint64_t> overruns{0};
  std::atomic<std::uint64_t> gaps{0};
  std::atomic<std::int64_t> lost_scans{0};  ///< Scans missing in gaps.
  std::atomic<std::int64_t> idle_scans{0};  ///< Scans that belong to no test.
};

/// Timing of a session.
struct SessionClocks {
  std::optional<daq::RateEstimate> scan_rate;  ///< From all scans so far.
  /// From a block's last scan to the end of its read.
  daq::LatencyHistogram latency;
};

class Session {
 public:
  /// \param sinks,counts  outlive the session. \param sinks  called on the processing thread.
  /// \throws std::invalid_argument as daq::Calibration and analysis::TestAnalysis.
  Session(drivers::OpenedBoard board, const SessionSettings& settings, std::vector<pipeline::Sink*> sinks,
          SessionEvents events, SessionCounts& counts);
  /// Requests the stop and blocks until all scans are processed.
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Starts the acquisition. Call it once. Errors: those of the board; then no event follows.
  [[nodiscard]] base::Result<void> start();
  /// Starts the processing thread, which calls sinks and events. Call it once, after start().
  void start_processing();
  /// Requests the end; does not block. The board stops, the ring is drained, a running test ends, then
  /// events.ended is called.
  void request_stop() noexcept { acquisition_.request_stop(); }

  /// A function that the processing thread calls between two blocks, as soon as possible.
  using Job = std::function<void(pipeline::Processor&)>;
  /// Queues a job; does not block. Any thread. \return false if the job will never run: the session is over,
  /// or 64 jobs wait. Jobs left after the last scan still run; the bench is degraded then.
  [[nodiscard]] bool post(Job job);

  [[nodiscard]] const daq::BoardInfo& board_info() const noexcept { return board_.board->info(); }
  /// Why the board ended. Valid after events.ended.
  [[nodiscard]] std::string board_error() const { return board_.board->last_error(); }
  [[nodiscard]] const std::string& scheduling() const noexcept { return acquisition_.scheduling(); }
  /// Phase, regime and latest cycle of the running test, after the latest block. Any thread.
  [[nodiscard]] detect::LiveState live() const {
    const std::lock_guard lock{live_mutex_};
    return live_;
  }
  /// Why the bench stays in its state. Any thread.
  [[nodiscard]] pipeline::BenchTrouble bench_trouble() const noexcept {
    return bench_trouble_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] pipeline::BenchState bench() const noexcept { return bench_.load(std::memory_order_relaxed); }
  /// Timing so far. Any thread.
  [[nodiscard]] SessionClocks clocks() const {
    const std::lock_guard lock{live_mutex_};
    return clocks_;
  }
  /// Capacity of the ring and most blocks that waited in it. Any thread.
  [[nodiscard]] daq::ScanRing::Use ring_use() const noexcept { return ring_.use(); }
  /// Scans that the board has delivered. Any thread.
  [[nodiscard]] std::uint64_t delivered_scan_count() const noexcept {
    return acquisition_.delivered_scan_count();
  }
  /// Scan indices that the board has issued, for scans delivered or lost. Any thread.
  [[nodiscard]] std::int64_t issued_index_count() const noexcept { return acquisition_.issued_index_count(); }
  /// Where the session ended. Valid after events.ended.
  [[nodiscard]] SessionEnd end() const;

 private:
  /// What the processor has counted so far.
  struct Progress {
    std::uint64_t gaps;
    std::int64_t lost_scans;
    std::int64_t idle_scans;
  };

  void process();
  /// Processes blocks until the ring is empty, at most as many as it holds, so that commands are not starved.
  /// \param blocks  buffer. \return true if the ring is empty.
  [[nodiscard]] bool process_waiting(std::vector<daq::ScanBlock>& blocks);
  /// After the last block.
  void finish(Acquisition::End ended);
  [[nodiscard]] Progress progress() const noexcept;
  void count_since(const Progress& before) noexcept;
  void process_block(const daq::ScanBlock& block);
  /// Moves posted jobs to taken_jobs_, for run_jobs().
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
  mutable std::mutex live_mutex_;  ///< Held only to copy; the acquisition thread never takes it.
  detect::LiveState live_;
  std::atomic<pipeline::BenchState> bench_;
  std::atomic<pipeline::BenchTrouble> bench_trouble_ = pipeline::BenchTrouble::kNone;
  SessionClocks clocks_;
  std::uint64_t dropped_before_ = 0;
  std::uint64_t suspends_before_ = 0;
  std::uint64_t overruns_before_ = 0;
  std::int64_t lost_at_end_ = 0;
  FullRing full_ring_;
  std::mutex jobs_mutex_;
  std::deque<Job> jobs_;        ///< At most kMostJobs.
  std::deque<Job> taken_jobs_;  ///< Processing thread only: the jobs it runs next.
  bool jobs_closed_ = false;
  bool any_scan_ = false;
  /// True if this session follows another one; the gap before its first scan has the cause board-missing.
  bool continues_;
  std::thread thread_;
};

}  // namespace stickslip::runtime
