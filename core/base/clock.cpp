#include "core/base/clock.hpp"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stickslip::base {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
/// Bound of one sleep: the accelerated clock maps through CLOCK_MONOTONIC_RAW, which
/// clock_nanosleep cannot wait on, so long waits are re-measured.
constexpr std::int64_t kLongestSleep_ns = 50'000'000;

std::int64_t read_clock(clockid_t id) {
  timespec now{};
  clock_gettime(id, &now);
  return now.tv_sec * kNanosecondsPerSecond + now.tv_nsec;
}

class SystemClock final : public Clock {
 public:
  explicit SystemClock(double speed)
      : speed_(speed),
        origin_monotonic_ns_(read_clock(CLOCK_MONOTONIC_RAW)),
        origin_realtime_ns_(read_clock(CLOCK_REALTIME)) {}

  [[nodiscard]] std::int64_t monotonic_ns() const override {
    return origin_monotonic_ns_ + scaled(read_clock(CLOCK_MONOTONIC_RAW) - origin_monotonic_ns_);
  }

  [[nodiscard]] std::int64_t realtime_ns() const override {
    return origin_realtime_ns_ + scaled(read_clock(CLOCK_REALTIME) - origin_realtime_ns_);
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
};

}  // namespace

std::unique_ptr<Clock> make_system_clock(double speed) {
  if (!(speed > 0.0) || !std::isfinite(speed)) {
    throw std::invalid_argument(fmt::format("clock speed {} must be positive and finite", speed));
  }
  return std::make_unique<SystemClock>(speed);
}

}  // namespace stickslip::base
