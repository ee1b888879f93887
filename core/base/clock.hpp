/// \file
/// Time as a parameter: who needs a clock takes one, so that tests move it by hand and the
/// simulated bench runs faster than the wall. Results never use these clocks: their time is
/// the scan index over the granted rate.
#pragma once

#include <cstdint>
#include <memory>

namespace stickslip::base {

/// Thread-safe. Times are nanoseconds.
class Clock {
 public:
  virtual ~Clock() = default;

  /// CLOCK_MONOTONIC_RAW, or what stands for it: never steps, not slewed by NTP.
  [[nodiscard]] virtual std::int64_t monotonic_ns() const = 0;
  /// Since 1970-01-01T00:00:00Z.
  [[nodiscard]] virtual std::int64_t realtime_ns() const = 0;
  /// Blocks until monotonic_ns() ≥ deadline_ns; returns at once if it is already.
  virtual void sleep_until(std::int64_t deadline_ns) = 0;
};

/// The machine's clock, `speed` times as fast from the moment of construction on
/// (1 = the machine's own time).
/// \throws std::invalid_argument unless speed is positive and finite.
[[nodiscard]] std::unique_ptr<Clock> make_system_clock(double speed = 1.0);

/// The same clock, but that its date is put right now and then: in each stretch of `every_s` of its time,
/// from the second on, realtime_ns() is off by another amount, uniform to ±kLargestClockStep_s, that follows
/// from the seed. \throws std::invalid_argument unless every_s is positive and finite.
[[nodiscard]] std::unique_ptr<Clock> make_stepping_clock(std::unique_ptr<Clock> clock, double every_s,
                                                         std::uint64_t seed);

inline constexpr double kLargestClockStep_s = 3600.0;

}  // namespace stickslip::base
