/// \file
/// The acquisition thread: reads the board, pushes to the ring, wakes the processing thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <semaphore>
#include <string>
#include <thread>

#include "core/base/result.hpp"
#include "core/daq/board.hpp"
#include "core/daq/scan_ring.hpp"
#include "daemon/realtime.hpp"

namespace stickslip::daemon {

/// Between start and end its thread never allocates, locks, logs or formats.
class Acquisition {
 public:
  /// Why there will be no more blocks.
  enum class End : std::uint8_t { kStopped, kEndOfInput, kBoardMissing, kFailed };

  /// Board and ring must outlive this object.
  Acquisition(daq::Board& board, daq::ScanRing& ring, RealtimeSettings realtime);
  /// Stops and waits for the thread.
  ~Acquisition();
  Acquisition(const Acquisition&) = delete;
  Acquisition& operator=(const Acquisition&) = delete;

  /// Starts the board, then the thread. Once. Errors: those of the board.
  [[nodiscard]] base::Result<void> start();
  /// Any thread; the thread ends within one read timeout.
  void request_stop() noexcept { stop_requested_.store(true, std::memory_order_relaxed); }

  /// Consumer: blocks until there is a block in the ring, the thread has ended, or somebody called wake().
  void wait() noexcept { news_.acquire(); }
  /// Any thread.
  void wake() noexcept { news_.release(); }
  /// Once set, all blocks are in the ring: whoever sees it and then empties the ring has them all.
  [[nodiscard]] std::optional<End> ended() const noexcept;

  /// Scheduling in use; valid after start().
  [[nodiscard]] const std::string& scheduling() const noexcept { return scheduling_; }

 private:
  void run() noexcept;
  [[nodiscard]] End read_to_the_end() noexcept;

  static constexpr std::uint8_t kRunning = 0xFF;

  daq::Board& board_;
  daq::ScanRing& ring_;
  RealtimeSettings realtime_;
  std::string scheduling_;
  std::atomic<bool> stop_requested_{false};
  std::atomic<std::uint8_t> end_{kRunning};
  std::uint64_t overruns_ = 0;  ///< Of the thread: blocks carry it.
  std::counting_semaphore<> news_{0};
  std::binary_semaphore started_{0};
  std::thread thread_;
};

}  // namespace stickslip::daemon
