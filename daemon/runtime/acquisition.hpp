/// \file
/// The acquisition thread: reads the board, pushes to the ring, wakes the processing thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>

#include "core/base/result.hpp"
#include "core/base/semaphore.hpp"
#include "core/daq/board.hpp"
#include "core/daq/scan_ring.hpp"
#include "daemon/runtime/realtime.hpp"

namespace stickslip::runtime {

/// What becomes of a block that finds the ring full.
enum class FullRing : std::uint8_t {
  kDrop,  ///< Dropped and counted: a board does not wait for its computer.
  kWait,  ///< The thread waits. Only where the scans wait as well: simulated or replayed, and not in real
          ///< time.
};

/// Between start and end its thread never allocates, locks, logs or formats.
class Acquisition {
 public:
  /// Why there will be no more blocks.
  enum class End : std::uint8_t { kStopped, kEndOfInput, kBoardMissing, kFailed };

  /// Board and ring must outlive this object.
  /// \param issued_before  where the indices of the board before this one ended, of which it goes on; none:
  /// there was none.
  Acquisition(daq::Board& board, daq::ScanRing& ring, io::RealtimeSettings realtime,
              FullRing full_ring = FullRing::kDrop, std::optional<daq::ScanIndex> issued_before = {});
  /// Stops and waits for the thread.
  ~Acquisition();
  Acquisition(const Acquisition&) = delete;
  Acquisition& operator=(const Acquisition&) = delete;

  /// Starts the board, then the thread. Once. Errors: those of the board.
  [[nodiscard]] base::Result<void> start();
  /// Any thread; the thread ends within one read timeout.
  void request_stop() noexcept {
    stop_requested_.store(true, std::memory_order_relaxed);
    made_room();
  }

  /// Consumer: waits until there are blocks in the ring, the oldest at most 4 ms older than the latest, or
  /// the thread has ended, or somebody called wake().
  void wait() noexcept { news_.acquire(); }
  /// Any thread.
  void wake() noexcept { news_.release(); }
  /// Consumer: blocks were taken out of the ring. Needed with FullRing::kWait only.
  void made_room() noexcept {
    room_made_.fetch_add(1, std::memory_order_release);
    room_made_.notify_one();
  }
  /// Once set, all blocks are in the ring: whoever sees it and then empties the ring has them all.
  [[nodiscard]] std::optional<End> ended() const noexcept;

  /// Any thread: scans that the board has delivered.
  [[nodiscard]] std::uint64_t delivered_scan_count() const noexcept {
    return delivered_.load(std::memory_order_acquire);
  }

  /// Any thread: indices that the board has given, of scans that it delivered or lost.
  [[nodiscard]] std::int64_t issued_index_count() const noexcept {
    return issued_.load(std::memory_order_relaxed);
  }

  /// Only after ended(): indices that the board lost after the latest block that the ring took and before a
  /// later one, which the ring dropped. No block tells the consumer of them.
  [[nodiscard]] std::int64_t untold_lost_count() const noexcept { return untold_lost_; }

  /// Scheduling in use; valid after start().
  [[nodiscard]] const std::string& scheduling() const noexcept { return scheduling_; }

 private:
  void run() noexcept;
  void hand_over(daq::ScanBlock& block) noexcept;
  void wait_for_room() noexcept;
  void tell() noexcept;
  [[nodiscard]] End read_to_the_end() noexcept;

  static constexpr std::uint8_t kRunning = 0xFF;

  daq::Board& board_;
  daq::ScanRing& ring_;
  io::RealtimeSettings realtime_;
  FullRing full_ring_;
  std::string scheduling_;
  std::atomic<bool> stop_requested_{false};
  std::atomic<std::uint8_t> end_{kRunning};
  std::atomic<std::uint64_t> delivered_{0};
  std::atomic<std::int64_t> issued_{0};
  // Of the thread.
  std::optional<daq::ScanIndex> issued_end_;
  std::int64_t untold_lost_ = 0;
  std::uint64_t overruns_ = 0;  ///< Blocks carry it.
  bool untold_ = false;         ///< There are blocks in the ring that the consumer was not woken for.
  std::int64_t told_ns_ = 0;    ///< Stamp of the latest block that it was woken for.
  base::Semaphore news_;
  std::atomic<std::uint32_t> room_made_{0};  ///< Times; also counted when the thread is to stop.
  base::Semaphore started_;
  std::thread thread_;
};

}  // namespace stickslip::runtime
