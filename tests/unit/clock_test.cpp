#include "core/base/clock.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include "tests/support/manual_clock.hpp"

namespace stickslip::test {
namespace {

using namespace std::chrono_literals;

TEST(SystemClock, NeverRunsBackwards) {
  const auto clock = base::make_system_clock();
  std::int64_t last_ns = clock->monotonic_ns();
  for (int i = 0; i < 10'000; ++i) {
    const std::int64_t now_ns = clock->monotonic_ns();
    ASSERT_GE(now_ns, last_ns);
    last_ns = now_ns;
  }
}

// An hour of a clock ten million times as fast is 0.36 ms of the wall: a sleep that ignored the speed
// would run into the time limit of the test program.
TEST(SystemClock, FastClockSleepsByItsOwnTime) {
  const auto clock = base::make_system_clock(1e7);
  const std::int64_t deadline_ns = clock->monotonic_ns() + std::chrono::nanoseconds(1h).count();
  clock->sleep_until(deadline_ns);
  EXPECT_GE(clock->monotonic_ns(), deadline_ns);
}

// Bounds without an upper limit of the wall clock: between two readings of the plain clock, the fast
// one must have made at least the inner and at most the outer time, times its speed.
TEST(SystemClock, SpeedMultipliesTheElapsedTime) {
  constexpr double kSpeed = 1000.0;
  const auto plain = base::make_system_clock();
  const auto fast = base::make_system_clock(kSpeed);
  const std::int64_t outer_began_ns = plain->monotonic_ns();
  const std::int64_t fast_began_ns = fast->monotonic_ns();
  const std::int64_t inner_began_ns = plain->monotonic_ns();
  while (plain->monotonic_ns() - inner_began_ns < 1'000'000) {
  }
  const std::int64_t inner_ended_ns = plain->monotonic_ns();
  const std::int64_t fast_ended_ns = fast->monotonic_ns();
  const std::int64_t outer_ended_ns = plain->monotonic_ns();
  const auto fast_ns = static_cast<double>(fast_ended_ns - fast_began_ns);
  // Both readings of the fast clock are rounded to 1 ns.
  EXPECT_GE(fast_ns, kSpeed * static_cast<double>(inner_ended_ns - inner_began_ns) - 1.0);
  EXPECT_LE(fast_ns, kSpeed * static_cast<double>(outer_ended_ns - outer_began_ns) + 1.0);
}

TEST(SteppingClock, PutsItsDateRightNowAndThenAndNeverItsPace) {
  auto manual = std::make_unique<ManualClock>();
  ManualClock& time = *manual;
  const auto clock = base::make_stepping_clock(std::move(manual), 60.0, 7);
  const auto off_s = [&] { return 1e-9 * static_cast<double>(clock->realtime_ns() - time.realtime_ns()); };
  EXPECT_EQ(off_s(), 0.0);
  double before = 0.0;
  int steps = 0;
  for (int minute = 0; minute < 100; ++minute) {
    time.advance(61s);
    EXPECT_EQ(clock->monotonic_ns(), time.monotonic_ns());
    EXPECT_LE(std::abs(off_s()), base::kLargestClockStep_s);
    if (off_s() != before) ++steps;
    before = off_s();
  }
  EXPECT_EQ(steps, 100);
  EXPECT_THROW(static_cast<void>(base::make_stepping_clock(base::make_system_clock(), 0.0, 1)),
               std::invalid_argument);
}

TEST(SystemClock, SleepUntilThePastReturnsAtOnce) {
  const auto clock = base::make_system_clock();
  clock->sleep_until(clock->monotonic_ns() - 1);
  clock->sleep_until(std::numeric_limits<std::int64_t>::min() / 2);
}

TEST(SystemClock, ImpossibleSpeedsAreRefused) {
  for (const double speed : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    EXPECT_THROW(static_cast<void>(base::make_system_clock(speed)), std::invalid_argument) << speed;
  }
}

TEST(ManualClock, SleepingMovesTheTimeForwardOnly) {
  ManualClock clock(1000, 5000);
  clock.sleep_until(4000);
  EXPECT_EQ(clock.monotonic_ns(), 4000);
  EXPECT_EQ(clock.realtime_ns(), 8000);
  clock.sleep_until(2000);
  EXPECT_EQ(clock.monotonic_ns(), 4000);
  clock.advance(1us);
  EXPECT_EQ(clock.monotonic_ns(), 5000);
}

}  // namespace
}  // namespace stickslip::test
