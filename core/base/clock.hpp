/// \file
/// Clocks, passed as parameters: tests move theirs by hand, and a simulated bench runs faster than real time.
/// Times in results are not read from these clocks: they are the scan index over the granted rate.
#pragma once

#include <cstdint>
#include <memory>

namespace stickslip::base {

/// Monotonic time and date, in nanoseconds. Thread-safe.
class Clock {
 public:
  virtual ~Clock() = default;

  /// Time since an arbitrary origin. It never goes back, is not slewed by NTP, and steps only after a suspend
  /// of the computer, by its length times the clock's speed.
  [[nodiscard]] virtual std::int64_t monotonic_ns() const = 0;
  /// Time for which the computer has been suspended since the clock was made, by the computer's own time even
  /// if the clock is accelerated. A suspend shorter than 10 ms is not seen.
  [[nodiscard]] virtual std::int64_t suspended_ns() const { return 0; }
  /// Date, since 1970-01-01T00:00:00Z; it may step.
  [[nodiscard]] virtual std::int64_t realtime_ns() const = 0;
  /// Blocks until monotonic_ns() ≥ deadline_ns; returns at once if it is already.
  virtual void sleep_until(std::int64_t deadline_ns) = 0;
};

/// The machine's clock (CLOCK_MONOTONIC_RAW and CLOCK_REALTIME), `speed` times as fast from the moment of
/// construction on (1 = the machine's own time).
/// \throws std::invalid_argument unless speed is positive and finite.
[[nodiscard]] std::unique_ptr<Clock> make_system_clock(double speed = 1.0);

/// Wraps a clock so that its date steps, for tests. In the first interval of `every_s`, counted by
/// monotonic_ns() from construction, realtime_ns() is that of `clock`; in each later one it has another
/// error, uniform in ±kLargestClockStep_s and determined by the seed. All repeats after 1024 intervals.
/// \throws std::invalid_argument unless every_s is positive and finite.
[[nodiscard]] std::unique_ptr<Clock> make_stepping_clock(std::unique_ptr<Clock> clock, double every_s,
                                                         std::uint64_t seed);

/// Largest error of realtime_ns() of a stepping clock, s.
inline constexpr double kLargestClockStep_s = 3600.0;

}  // namespace stickslip::base
