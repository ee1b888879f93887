/// \file
/// Clocks, passed as parameters: tests move theirs by hand, and a simulated bench runs faster than real time.
/// Results never depend on these clocks: their time is the scan index over the granted rate.
#pragma once

#include <cstdint>
#include <memory>

namespace stickslip::base {

/// Thread-safe. Times are nanoseconds.
class Clock {
 public:
  virtual ~Clock() = default;

  /// CLOCK_MONOTONIC_RAW or its replacement, and suspended_ns(): goes on while the computer is suspended,
  /// never steps else, is not slewed by NTP.
  [[nodiscard]] virtual std::int64_t monotonic_ns() const = 0;
  /// Time for which the computer has been suspended since the clock was made; a suspend shorter than 10 ms
  /// does not count.
  [[nodiscard]] virtual std::int64_t suspended_ns() const { return 0; }
  /// Since 1970-01-01T00:00:00Z.
  [[nodiscard]] virtual std::int64_t realtime_ns() const = 0;
  /// Blocks until monotonic_ns() ≥ deadline_ns; returns at once if it is already.
  virtual void sleep_until(std::int64_t deadline_ns) = 0;
};

/// The machine's clock, `speed` times as fast from the moment of construction on
/// (1 = the machine's own time).
/// \throws std::invalid_argument unless speed is positive and finite.
[[nodiscard]] std::unique_ptr<Clock> make_system_clock(double speed = 1.0);

/// Wraps a clock so that its date steps, for tests. In each interval of `every_s` after the first,
/// realtime_ns() has another error, uniform in ±kLargestClockStep_s and determined by the seed.
/// \throws std::invalid_argument unless every_s is positive and finite.
[[nodiscard]] std::unique_ptr<Clock> make_stepping_clock(std::unique_ptr<Clock> clock, double every_s,
                                                         std::uint64_t seed);

/// Largest error of realtime_ns() of a stepping clock, s.
inline constexpr double kLargestClockStep_s = 3600.0;

}  // namespace stickslip::base
