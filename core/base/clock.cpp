#include "core/base/clock.hpp"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <random>
#include <stdexcept>
#include <utility>

namespace stickslip::base {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
/// Bound of one sleep: the accelerated clock maps through CLOCK_MONOTONIC_RAW, which
/// clock_nanosleep cannot wait on, so long waits are re-measured.
constexpr std::int64_t kLongestSleep_ns = 50'000'000;
/// No computer suspends and resumes within it, and two clocks that are read one after the other disagree by
/// less as a rule.
constexpr std::int64_t kShortestSuspend_ns = 10'000'000;

std::int64_t read_clock(clockid_t id) {
  timespec now{};
  clock_gettime(id, &now);
  return now.tv_sec * kNanosecondsPerSecond + now.tv_nsec;
}

/// CLOCK_BOOTTIME goes on in a suspend, else it is CLOCK_MONOTONIC. Read in this order, their difference is
/// never too large; it is too small by the time for which the thread had to wait in between.
std::int64_t suspended_since_boot_ns() {
  const std::int64_t boot_ns = read_clock(CLOCK_BOOTTIME);
  return boot_ns - read_clock(CLOCK_MONOTONIC);
}

class SystemClock final : public Clock {
 public:
  explicit SystemClock(double speed)
      : speed_(speed),
        origin_monotonic_ns_(read_clock(CLOCK_MONOTONIC_RAW)),
        origin_realtime_ns_(read_clock(CLOCK_REALTIME)),
        origin_suspended_ns_(suspended_since_boot_ns()) {
    // A thread that had to wait between its two readings is off by that.
    constexpr int kReadings = 8;
    for (int i = 1; i < kReadings; ++i)
      origin_suspended_ns_ = std::max(origin_suspended_ns_, suspended_since_boot_ns());
  }

  [[nodiscard]] std::int64_t monotonic_ns() const override {
    const std::int64_t elapsed_ns = read_clock(CLOCK_MONOTONIC_RAW) + suspended_ns() - origin_monotonic_ns_;
    return origin_monotonic_ns_ + scaled(elapsed_ns);
  }

  [[nodiscard]] std::int64_t realtime_ns() const override {
    return origin_realtime_ns_ + scaled(read_clock(CLOCK_REALTIME) - origin_realtime_ns_);
  }

  [[nodiscard]] std::int64_t suspended_ns() const override {
    const std::int64_t suspended_ns = suspended_since_boot_ns() - origin_suspended_ns_;
    std::int64_t known_ns = suspended_ns_.load(std::memory_order_relaxed);
    while (suspended_ns > known_ns + kShortestSuspend_ns) {
      if (suspended_ns_.compare_exchange_weak(known_ns, suspended_ns, std::memory_order_relaxed))
        return suspended_ns;
    }
    return known_ns;
  }

  void sleep_until(std::int64_t deadline_ns) override {
    for (std::int64_t left = deadline_ns - monotonic_ns(); left > 0; left = deadline_ns - monotonic_ns()) {
      const double wall_ns = std::ceil(static_cast<double>(left) / speed_);
      const auto step = static_cast<std::int64_t>(std::min(wall_ns, static_cast<double>(kLongestSleep_ns)));
      const timespec duration{step / kNanosecondsPerSecond, step % kNanosecondsPerSecond};
      clock_nanosleep(CLOCK_MONOTONIC, 0, &duration, nullptr);
    }
  }

 private:
  [[nodiscard]] std::int64_t scaled(std::int64_t elapsed_ns) const {
    return speed_ == 1.0 ? elapsed_ns
                         : static_cast<std::int64_t>(std::llround(static_cast<double>(elapsed_ns) * speed_));
  }

  double speed_;
  std::int64_t origin_monotonic_ns_;
  std::int64_t origin_realtime_ns_;
  std::int64_t origin_suspended_ns_;
  mutable std::atomic<std::int64_t> suspended_ns_{0};
};

class SteppingClock final : public Clock {
 public:
  SteppingClock(std::unique_ptr<Clock> clock, double every_s, std::uint64_t seed)
      : clock_(std::move(clock)), every_s_(every_s), begin_ns_(clock_->monotonic_ns()) {
    // Drawn in advance, since a thread that reads the clock may not allocate.
    std::mt19937_64 random{seed};
    std::uniform_real_distribution<double> step_s{-kLargestClockStep_s, kLargestClockStep_s};
    for (std::int64_t& step : steps_ns_) step = std::llround(1e9 * step_s(random));
    steps_ns_.front() = 0;
  }

  [[nodiscard]] std::int64_t monotonic_ns() const override { return clock_->monotonic_ns(); }
  [[nodiscard]] std::int64_t suspended_ns() const override { return clock_->suspended_ns(); }
  [[nodiscard]] std::int64_t realtime_ns() const override {
    const double elapsed_s = 1e-9 * static_cast<double>(clock_->monotonic_ns() - begin_ns_);
    return clock_->realtime_ns() + steps_ns_[static_cast<std::size_t>(elapsed_s / every_s_) % kSteps];
  }
  void sleep_until(std::int64_t deadline_ns) override { clock_->sleep_until(deadline_ns); }

 private:
  static constexpr std::size_t kSteps = 1024;  ///< The sequence repeats after this number.

  std::unique_ptr<Clock> clock_;
  double every_s_;
  std::array<std::int64_t, kSteps> steps_ns_{};
  std::int64_t begin_ns_;
};

}  // namespace

std::unique_ptr<Clock> make_stepping_clock(std::unique_ptr<Clock> clock, double every_s, std::uint64_t seed) {
  if (!(every_s > 0.0) || !std::isfinite(every_s)) {
    throw std::invalid_argument(
        fmt::format("steps of the clock every {} s must be positive and finite", every_s));
  }
  return std::make_unique<SteppingClock>(std::move(clock), every_s, seed);
}

std::unique_ptr<Clock> make_system_clock(double speed) {
  if (!(speed > 0.0) || !std::isfinite(speed)) {
    throw std::invalid_argument(fmt::format("clock speed {} must be positive and finite", speed));
  }
  return std::make_unique<SystemClock>(speed);
}

}  // namespace stickslip::base
