/// \file
/// A counting semaphore whose waiters sleep at once. That of GCC 12 gives its processor away several times
/// before: three threads that wait 350 times a second each spent more on that than on the scans.
#pragma once

#include <semaphore.h>

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <ctime>

namespace stickslip::base {

/// Any threads. The count may reach INT_MAX.
class Semaphore {
 public:
  explicit Semaphore(unsigned count = 0) noexcept { static_cast<void>(::sem_init(&semaphore_, 0, count)); }
  ~Semaphore() { static_cast<void>(::sem_destroy(&semaphore_)); }
  Semaphore(const Semaphore&) = delete;
  Semaphore& operator=(const Semaphore&) = delete;

  /// Does not wait, and calls the kernel only if somebody else does.
  void release() noexcept { static_cast<void>(::sem_post(&semaphore_)); }

  void acquire() noexcept {
    while (::sem_wait(&semaphore_) != 0) {  // Signals interrupt it.
    }
  }
  [[nodiscard]] bool try_acquire() noexcept { return ::sem_trywait(&semaphore_) == 0; }
  /// \return false if it was not released in time.
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
