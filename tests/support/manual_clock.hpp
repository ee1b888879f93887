/// \file
/// A clock that stands still until it is moved: tests of hours in milliseconds.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

#include "core/base/clock.hpp"

namespace stickslip::test {

/// Thread-safe. Whoever sleeps moves the time, so nothing ever waits.
class ManualClock final : public base::Clock {
 public:
  explicit ManualClock(std::int64_t monotonic_ns = 1'000'000'000,
                       std::int64_t realtime_ns = 1'700'000'000'000'000'000)
      : now_ns_(monotonic_ns), realtime_offset_ns_(realtime_ns - monotonic_ns) {}

  [[nodiscard]] std::int64_t monotonic_ns() const override { return now_ns_.load(); }
  [[nodiscard]] std::int64_t realtime_ns() const override {
    return now_ns_.load() + realtime_offset_ns_.load();
  }

  void sleep_until(std::int64_t deadline_ns) override {
    std::int64_t now_ns = now_ns_.load();
    while (now_ns < deadline_ns && !now_ns_.compare_exchange_weak(now_ns, deadline_ns)) {
    }
  }

  [[nodiscard]] std::int64_t suspended_ns() const override { return suspended_ns_.load(); }
  /// Suspends the computer: no program runs meanwhile.
  void suspend(std::chrono::nanoseconds time) {
    advance(time);
    suspended_ns_.fetch_add(time.count());
  }

  void advance(std::chrono::nanoseconds time) { now_ns_.fetch_add(time.count()); }
  /// Sets the date ahead, or back.
  void step_date(std::chrono::nanoseconds ahead) { realtime_offset_ns_.fetch_add(ahead.count()); }

 private:
  std::atomic<std::int64_t> now_ns_;
  std::atomic<std::int64_t> realtime_offset_ns_;
  std::atomic<std::int64_t> suspended_ns_{0};
};

}  // namespace stickslip::test
