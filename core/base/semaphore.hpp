/// \file
/// A counting semaphore whose waiters sleep at once. std::counting_semaphore of GCC 12 yields the processor
/// several times first: with three threads that each wait 350 times a second, this cost more than processing
/// the scans.
#pragma once

#include <semaphore.h>

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <ctime>

namespace stickslip::base {

/// Counting semaphore. Thread-safe. The count may reach INT_MAX.
class Semaphore {
 public:
  explicit Semaphore(unsigned count = 0) noexcept { static_cast<void>(::sem_init(&semaphore_, 0, count)); }
  ~Semaphore() { static_cast<void>(::sem_destroy(&semaphore_)); }
  Semaphore(const Semaphore&) = delete;
  Semaphore& operator=(const Semaphore&) = delete;

  /// Increments the count. Never blocks; calls the kernel only if a thread is waiting.
  void release() noexcept { static_cast<void>(::sem_post(&semaphore_)); }

  /// Decrements the count; waits while it is 0.
  void acquire() noexcept {
    while (::sem_wait(&semaphore_) != 0) {  // Signals interrupt it.
    }
  }
  /// Decrements the count unless it is 0. \return false if it is 0.
  [[nodiscard]] bool try_acquire() noexcept { return ::sem_trywait(&semaphore_) == 0; }
  /// Decrements the count; waits at most `timeout`. \return false after the timeout.
  [[nodiscard]] bool try_acquire_for(std::chrono::milliseconds timeout) noexcept {
    constexpr std::int64_t kPerSecond = 1'000'000'000;
    timespec deadline{};
    static_cast<void>(::clock_gettime(CLOCK_MONOTONIC, &deadline));
    const std::int64_t ns = deadline.tv_nsec + std::chrono::nanoseconds{timeout}.count();
    deadline.tv_sec += ns / kPerSecond;
    deadline.tv_nsec = ns % kPerSecond;
    while (::sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &deadline) != 0) {
      if (errno != EINTR) return false;
    }
    return true;
  }

 private:
  ::sem_t semaphore_{};
};

}  // namespace stickslip::base
