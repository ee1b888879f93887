/// \file
/// The bounded queue between the acquisition thread and the processing thread.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include <boost/lockfree/spsc_queue.hpp>

#include "core/daq/scan_block.hpp"

namespace stickslip::daq {

/// Lock-free queue of blocks for a single producer and a single consumer. When it is full the new block is
/// dropped and its scans are counted: the producer never waits; the consumer sees the jump in the index.
class ScanRing {
 public:
  /// \param capacity  blocks: of at least 60 s (capacity_for()) if the producer drops what finds no room; 1 s
  ///        is enough for one that waits for has_room().
  explicit ScanRing(std::size_t capacity) : queue_(capacity), capacity_(capacity) {}

  /// Capacity in blocks that holds `bridge_s` seconds, for reads that deliver a short block every 5 ms
  /// (Comedi at 250 Hz: every 8 ms) as well as full blocks. A board that delivers each scan singly fills it
  /// sooner above 203 scans/s.
  [[nodiscard]] static std::size_t capacity_for(double scan_rate_Hz, double bridge_s = 60.0) {
    constexpr double kReadsPerSecond = 200.0;
    const double full_blocks_per_second = scan_rate_Hz / static_cast<double>(ScanBlock::kMaxScans);
    return static_cast<std::size_t>(bridge_s * (kReadsPerSecond + full_blocks_per_second)) + 1;
  }

  /// Writes every page once, so that the producer's first round through the ring takes no page faults;
  /// empties the ring. Call before producer and consumer start.
  void touch() {
    const ScanBlock block;
    while (queue_.push(block)) {
    }
    queue_.reset();
  }

  /// Any thread; for the producer, true holds until its next push().
  [[nodiscard]] bool has_room() const noexcept { return queue_.write_available() > 0; }

  /// Producer only. \return false if the block was dropped.
  bool push(const ScanBlock& block) noexcept {
    if (queue_.push(block)) return true;
    dropped_scans_.fetch_add(block.count, std::memory_order_relaxed);
    return false;
  }

  /// Consumer only. \return blocks copied to `out`, at most `most`.
  std::size_t pop(ScanBlock* out, std::size_t most) noexcept {
    // Between two pops the ring only fills: the most that ever waited is what some pop finds.
    const std::size_t waiting = queue_.read_available();
    if (waiting > high_water_.load(std::memory_order_relaxed)) {
      high_water_.store(waiting, std::memory_order_relaxed);
    }
    return queue_.pop(out, most);
  }

  /// Use of the ring, in blocks.
  struct Use {
    std::size_t capacity = 0;
    std::size_t high_water = 0;  ///< Most blocks found waiting by a pop().
  };
  /// Any thread.
  [[nodiscard]] Use use() const noexcept { return {capacity_, high_water_.load(std::memory_order_relaxed)}; }

  /// Number of scans in all dropped blocks. Any thread.
  [[nodiscard]] std::uint64_t dropped_scan_count() const noexcept {
    return dropped_scans_.load(std::memory_order_relaxed);
  }

 private:
  boost::lockfree::spsc_queue<ScanBlock> queue_;
  std::size_t capacity_;
  std::atomic<std::size_t> high_water_{0};
  std::atomic<std::uint64_t> dropped_scans_{0};
};

}  // namespace stickslip::daq
