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

/// What happens to a block when the ring is full.
enum class FullRing : std::uint8_t {
  kDrop,  ///< The block is dropped and counted. For real boards, which cannot wait.
  kWait,  ///< The acquisition thread blocks until there is room. Only for simulated or replayed scans that
          ///< are not in real time.
};

/// Owns the acquisition thread. After its start the thread never allocates, locks, logs or formats.
class Acquisition {
 public:
  /// Why the acquisition ended.
  enum class End : std::uint8_t { kStopped, kEndOfInput, kBoardMissing, kFailed };

  /// \param board,ring  outlive this object. \param issued_before  end of the scan indices of the previous
  /// session, which this one continues; absent: this is the first session.
  Acquisition(daq::Board& board, daq::ScanRing& ring, io::RealtimeSettings realtime,
              FullRing full_ring = FullRing::kDrop, std::optional<daq::ScanIndex> issued_before = {});
  /// Requests the stop and blocks until the thread has ended.
  ~Acquisition();
  Acquisition(const Acquisition&) = delete;
  Acquisition& operator=(const Acquisition&) = delete;

  /// Starts the board, then the thread. Call it once. Errors: those of the board.
  [[nodiscard]] base::Result<void> start();
  /// Requests the end of the acquisition; does not block. The thread ends within 100 ms. Any thread.
  void request_stop() noexcept {
    stop_requested_.store(true, std::memory_order_relaxed);
    made_room();
  }

  /// Consumer: blocks until new blocks are announced, the acquisition has ended or wake() was called. The
  /// thread announces blocks at most once in 4 ms.
  void wait() noexcept { news_.acquire(); }
  /// Ends the consumer's wait(). Any thread.
  void wake() noexcept { news_.release(); }
  /// Consumer: states that blocks were taken out of the ring. Needed with FullRing::kWait only.
  void made_room() noexcept {
    room_made_.fetch_add(1, std::memory_order_release);
    room_made_.notify_one();
  }
  /// Why the acquisition ended; nothing while it runs. Once it is set, the ring holds all remaining blocks.
  [[nodiscard]] std::optional<End> ended() const noexcept;

  /// Scans that the board has delivered. Any thread.
  [[nodiscard]] std::uint64_t delivered_scan_count() const noexcept {
    return delivered_.load(std::memory_order_acquire);
  }

  /// Scan indices that the board has issued, for scans delivered or lost. Any thread.
  [[nodiscard]] std::int64_t issued_index_count() const noexcept {
    return issued_.load(std::memory_order_relaxed);
  }

  /// Scans lost by the board behind the last block in the ring, which no block tells the consumer. This
  /// happens if the ring dropped the next block. Valid after ended().
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
  std::uint64_t overruns_ = 0;  ///< Overruns so far; blocks carry the count.
  std::uint64_t suspends_ = 0;  ///< As overruns_.
  bool untold_ = false;         ///< The ring holds blocks that were not announced.
  std::int64_t told_ns_ = 0;    ///< Stamp of the block announced last.
  base::Semaphore news_;
  std::atomic<std::uint32_t> room_made_{0};  ///< Number of made_room() calls; request_stop() adds one.
  base::Semaphore started_;
  std::thread thread_;
};

}  // namespace stickslip::runtime
