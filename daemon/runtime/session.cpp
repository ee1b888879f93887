#include "daemon/runtime/session.hpp"

#include <utility>

#include "core/base/contract.hpp"
#include "core/base/thread_name.hpp"

namespace stickslip::runtime {
namespace {

/// Most jobs in the queue. Users cannot give more commands: each waits for its answer.
constexpr std::size_t kMostJobs = 64;

pipeline::EndCause end_cause(Acquisition::End end) {
  switch (end) {
    case Acquisition::End::kStopped:
      return pipeline::EndCause::kStopped;
    case Acquisition::End::kEndOfInput:
      return pipeline::EndCause::kEndOfInput;
    case Acquisition::End::kBoardMissing:
    case Acquisition::End::kFailed:
      break;
  }
  return pipeline::EndCause::kBoardMissing;
}

std::size_t ring_capacity(const daq::BoardInfo& board, const SessionSettings& settings) {
  const double scans_per_s = board.scan_rate_granted_Hz * settings.clock_speed;
  // A source that waits needs no more than what keeps it busy.
  return settings.full_ring == FullRing::kWait ? daq::ScanRing::capacity_for(scans_per_s, 1.0)
                                               : daq::ScanRing::capacity_for(scans_per_s);
}

daq::Calibration calibration_of(const drivers::OpenedBoard& board, const SessionSettings& settings) {
  return {board.board->info(), settings.load_cell, settings.processor.analysis.tester.normal_load_N()};
}

}  // namespace

Session::Session(drivers::OpenedBoard board, const SessionSettings& settings,
                 std::vector<pipeline::Sink*> sinks, SessionEvents events, SessionCounts& counts)
    : board_(std::move(board)),
      events_(std::move(events)),
      ring_(ring_capacity(board_.board->info(), settings)),
      processor_(settings.processor, calibration_of(board_, settings), std::move(sinks)),
      acquisition_(*board_.board, ring_, settings.realtime, settings.full_ring,
                   settings.processor.continues_at),
      counts_(counts),
      bench_(processor_.bench()),
      full_ring_(settings.full_ring),
      continues_(settings.processor.continues_at.has_value()) {
  STICKSLIP_EXPECTS(full_ring_ == FullRing::kDrop || !settings.processor.clock_is_real);
  ring_.touch();
}

Session::~Session() {
  acquisition_.request_stop();
  if (thread_.joinable()) thread_.join();
}

base::Result<void> Session::start() { return acquisition_.start(); }

void Session::start_processing() {
  thread_ = std::thread{[this] { process(); }};
}

void Session::process() {
  base::name_this_thread("processing");
  std::vector<daq::ScanBlock> blocks(64);
  for (;;) {
    acquisition_.wait();
    // Asked before the ring is emptied: then nothing can come after.
    const std::optional<Acquisition::End> ended = acquisition_.ended();
    for (bool emptied = false; !emptied;) {
      // Commands belong behind the scans that were there before them: what comes from here on waits for the
      // next time.
      take_jobs();
      emptied = process_waiting(blocks);
      run_jobs();
    }
    if (ended) {
      finish(*ended);
      close_jobs();
      take_jobs();
      run_jobs();
      events_.ended(*ended);
      return;
    }
  }
}

bool Session::process_waiting(std::vector<daq::ScanBlock>& blocks) {
  const std::size_t most = ring_.use().capacity;
  for (std::size_t done = 0; done < most;) {
    const std::size_t count = ring_.pop(blocks.data(), blocks.size());
    if (count == 0) return true;
    if (full_ring_ == FullRing::kWait) acquisition_.made_room();
    for (std::size_t i = 0; i < count; ++i) process_block(blocks[i]);
    done += count;
  }
  return false;
}

void Session::finish(Acquisition::End ended) {
  const Progress before = progress();
  processor_.finish(end_cause(ended));
  // The last blocks that a full ring dropped, and what the board lost between them: no later block says so.
  const std::uint64_t dropped = ring_.dropped_scan_count() - dropped_before_;
  lost_at_end_ = static_cast<std::int64_t>(dropped) + acquisition_.untold_lost_count();
  processor_.lost_at_end(lost_at_end_);
  counts_.dropped_scans.fetch_add(dropped, std::memory_order_relaxed);
  count_since(before);
}

Session::Progress Session::progress() const noexcept {
  return {processor_.gap_count(), processor_.lost_scan_count(), processor_.idle_scan_count()};
}

void Session::count_since(const Progress& before) noexcept {
  const Progress now = progress();
  counts_.gaps.fetch_add(now.gaps - before.gaps, std::memory_order_relaxed);
  counts_.lost_scans.fetch_add(now.lost_scans - before.lost_scans, std::memory_order_relaxed);
  counts_.idle_scans.fetch_add(now.idle_scans - before.idle_scans, std::memory_order_relaxed);
}

SessionEnd Session::end() const {
  SessionEnd end{processor_.test_number(), {processor_.rate_meter().continuation(), board_info()}};
  if (auto& continuation = end.before.continuation) continuation->end += lost_at_end_;
  return end;
}

bool Session::post(Job job) {
  {
    const std::lock_guard lock{jobs_mutex_};
    if (jobs_closed_ || jobs_.size() >= kMostJobs) return false;
    jobs_.push_back(std::move(job));
  }
  acquisition_.wake();
  return true;
}

void Session::take_jobs() {
  const std::lock_guard lock{jobs_mutex_};
  taken_jobs_.swap(jobs_);
}

void Session::run_jobs() {
  const Progress before = progress();
  for (const Job& job : taken_jobs_) job(processor_);
  count_since(before);
  taken_jobs_.clear();
  bench_.store(processor_.bench(), std::memory_order_relaxed);
  bench_trouble_.store(processor_.bench_trouble(), std::memory_order_relaxed);
}

void Session::close_jobs() {
  const std::lock_guard lock{jobs_mutex_};
  jobs_closed_ = true;
}

void Session::process_block(const daq::ScanBlock& block) {
  if (!any_scan_) {
    any_scan_ = true;
    events_.first_scan();
  }
  if (events_.block) events_.block(block);
  const std::uint64_t overruns = block.overrun_count - std::exchange(overruns_before_, block.overrun_count);
  const std::uint64_t suspends = block.suspend_count - std::exchange(suspends_before_, block.suspend_count);
  const std::uint64_t dropped =
      block.dropped_scan_count - std::exchange(dropped_before_, block.dropped_scan_count);
  const bool continues = std::exchange(continues_, false);
  daq::GapCause cause = daq::GapCause::kUnknown;
  if (overruns > 0) cause = daq::GapCause::kOverrun;
  if (dropped > 0) cause = daq::GapCause::kRingFull;
  if (suspends > 0) cause = daq::GapCause::kSuspended;
  if (continues) cause = daq::GapCause::kBoardMissing;
  const Progress before = progress();
  processor_.process(block, cause, continues || overruns > 0 || suspends > 0);
  const daq::RateMeter& meter = processor_.rate_meter();
  {
    const std::lock_guard lock{live_mutex_};
    live_ = processor_.live();
    clocks_.scan_rate = meter.estimate();
    if (const auto late_ns = meter.lateness_ns(block)) clocks_.latency.add(*late_ns);
  }
  bench_.store(processor_.bench(), std::memory_order_relaxed);
  bench_trouble_.store(processor_.bench_trouble(), std::memory_order_relaxed);
  counts_.dropped_scans.fetch_add(dropped, std::memory_order_relaxed);
  counts_.overruns.fetch_add(overruns, std::memory_order_relaxed);
  counts_.scans.fetch_add(block.count, std::memory_order_relaxed);
  count_since(before);
}

}  // namespace stickslip::runtime
