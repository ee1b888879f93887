#include "daemon/runtime/acquisition.hpp"

#include <chrono>

#include "core/base/contract.hpp"
#include "core/base/thread_name.hpp"

namespace stickslip::runtime {
namespace {

/// Longest wait for scans, and so for a stop request to take effect.
constexpr std::chrono::milliseconds kReadTimeout{100};
/// Shortest time between two wake-ups of the consumer, by the stamps of the blocks. A Comedi board may
/// deliver each scan singly. Live results may be 5 ms old.
constexpr std::int64_t kNewsPeriod_ns = 4'000'000;

}  // namespace

Acquisition::Acquisition(daq::Board& board, daq::ScanRing& ring, io::RealtimeSettings realtime,
                         FullRing full_ring, std::optional<daq::ScanIndex> issued_before)
    : board_(board), ring_(ring), realtime_(realtime), full_ring_(full_ring), issued_end_(issued_before) {}

Acquisition::~Acquisition() {
  request_stop();
  if (thread_.joinable()) thread_.join();
}

base::Result<void> Acquisition::start() {
  STICKSLIP_EXPECTS(!thread_.joinable());
  if (base::Result<void> started = board_.start(); !started) return started;
  thread_ = std::thread{[this] { run(); }};
  started_.acquire();
  return {};
}

std::optional<Acquisition::End> Acquisition::ended() const noexcept {
  const std::uint8_t end = end_.load(std::memory_order_acquire);
  if (end == kRunning) return std::nullopt;
  return static_cast<End>(end);
}

void Acquisition::run() noexcept {
  base::name_this_thread("acquisition");
  scheduling_ = use_realtime_scheduling(realtime_);
  started_.release();
  const End end = read_to_the_end();
  board_.stop();
  end_.store(static_cast<std::uint8_t>(end), std::memory_order_release);
  news_.release();
}

void Acquisition::tell() noexcept {
  if (!untold_) return;
  untold_ = false;
  news_.release();
}

void Acquisition::hand_over(daq::ScanBlock& block) noexcept {
  if (full_ring_ == FullRing::kWait) {
    wait_for_room();
    if (!ring_.has_room()) return;  // Told to stop: as if it had not been read.
  }
  const std::int64_t lost = block.first - issued_end_.value_or(block.first);
  // A reader that sees this count finds all earlier blocks in the ring.
  delivered_.fetch_add(block.count, std::memory_order_release);
  issued_.fetch_add(lost + block.count, std::memory_order_relaxed);
  issued_end_ = block.end();
  // A full ring counts what it drops; the jump in the index tells the consumer.
  block.overrun_count = overruns_;
  block.suspend_count = suspends_;
  block.dropped_scan_count = ring_.dropped_scan_count();
  untold_lost_ = ring_.push(block) ? 0 : untold_lost_ + lost;
  untold_ = true;
  if (block.stamp.monotonic_ns - told_ns_ < kNewsPeriod_ns) return;
  told_ns_ = block.stamp.monotonic_ns;
  tell();
}

void Acquisition::wait_for_room() noexcept {
  for (;;) {
    // Looked at first: room that is made after the ring was seen full is not slept through.
    const std::uint32_t seen = room_made_.load(std::memory_order_acquire);
    if (ring_.has_room() || stop_requested_.load(std::memory_order_relaxed)) return;
    tell();
    room_made_.wait(seen, std::memory_order_acquire);
  }
}

Acquisition::End Acquisition::read_to_the_end() noexcept {
  daq::ScanBlock block;
  while (!stop_requested_.load(std::memory_order_relaxed)) {
    switch (board_.read(block, kReadTimeout)) {
      case daq::ReadStatus::kScans:
        hand_over(block);
        break;
      case daq::ReadStatus::kTimeout:
        tell();
        break;
      case daq::ReadStatus::kOverrun:
        ++overruns_;
        // Scans are being lost anyway: starting again may take its time.
        if (!board_.start()) return End::kFailed;
        break;
      case daq::ReadStatus::kSuspended:
        ++suspends_;
        if (!board_.start()) return End::kFailed;
        break;
      case daq::ReadStatus::kEndOfInput:
        return End::kEndOfInput;
      case daq::ReadStatus::kBoardMissing:
        return End::kBoardMissing;
      case daq::ReadStatus::kFailed:
        return End::kFailed;
    }
  }
  return End::kStopped;
}

}  // namespace stickslip::runtime
