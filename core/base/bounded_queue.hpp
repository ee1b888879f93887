/// \file
/// A bounded queue between two threads that never drops an item: while it is full, push() blocks, and the
/// stall is counted.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <boost/lockfree/spsc_queue.hpp>

#include "core/base/semaphore.hpp"

namespace stickslip::base {

/// Queue of at most `capacity` items, which must be > 0, from one producer thread to one consumer thread.
template <typename T>
class BoundedQueue {
 public:
  explicit BoundedQueue(std::size_t capacity)
      : queue_(capacity), free_slots_(static_cast<unsigned>(capacity)) {}

  /// Producer only. Appends an item. The consumer sees it at once, with those put before. Blocks until
  /// the queue has room.
  void push(const T& item) {
    put(item);
    announce();
  }

  /// Producer only. Appends an item, which the consumer sees only after announce(), so that several items
  /// wake it once. Blocks until the queue has room; before it blocks, it announces the earlier items.
  void put(const T& item) {
    if (!free_slots_.try_acquire()) {
      stalls_.fetch_add(1, std::memory_order_relaxed);
      announce();  // Prevents a deadlock: the consumer must see the items put so far, to free a slot.
      free_slots_.acquire();
    }
    // The slot was free before it was acquired, so this cannot fail.
    queue_.push(item);
    ++put_;
  }
  /// Producer only. Makes all items put so far visible to the consumer.
  void announce() noexcept {
    for (; put_ > 0; --put_) items_.release();
  }

  /// Consumer only. Takes the oldest item; waits for one at most `timeout`. \return false after the timeout;
  /// `item` is then unchanged.
  bool pop(T& item, std::chrono::milliseconds timeout) {
    if (!items_.try_acquire_for(timeout)) return false;
    queue_.pop(item);
    free_slots_.release();
    return true;
  }

  /// Number of times the producer had to wait. Any thread.
  [[nodiscard]] std::uint64_t stall_count() const noexcept { return stalls_.load(std::memory_order_relaxed); }

 private:
  boost::lockfree::spsc_queue<T> queue_;
  Semaphore free_slots_;
  Semaphore items_;
  std::atomic<std::uint64_t> stalls_{0};
  unsigned put_ = 0;  ///< Items not announced yet; used by the producer only.
};

}  // namespace stickslip::base
