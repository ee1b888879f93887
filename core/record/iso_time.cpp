#include "core/record/iso_time.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <limits>

namespace stickslip::record {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

}  // namespace

std::string iso_time(std::int64_t realtime_ns) {
  using namespace std::chrono;
  // By hand: near the ends of the range the start of a second is no number of nanoseconds.
  const std::int64_t behind_ns = (realtime_ns % kSecond_ns + kSecond_ns) % kSecond_ns;
  const std::int64_t whole_s = realtime_ns / kSecond_ns - (realtime_ns % kSecond_ns < 0 ? 1 : 0);
  const sys_seconds time{seconds{whole_s}};
  const auto day = floor<days>(time);
  const year_month_day date{day};
  const hh_mm_ss clock{time - day};
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:09}+00:00", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                     clock.hours().count(), clock.minutes().count(), clock.seconds().count(), behind_ns);
}

std::optional<std::int64_t> ns_from_iso_time(std::string_view text) {
  using namespace std::chrono;
  int year = 0;
  unsigned month = 0;
  unsigned day = 0;
  int hour = 0;
  int minute = 0;
  int second = 0;
  std::int64_t ns = 0;
  const std::string terminated{text};
  if (std::sscanf(terminated.c_str(), "%4d-%2u-%2uT%2d:%2d:%2d.%9ld+00:00", &year, &month, &day, &hour,
                  &minute, &second, &ns) != 7) {
    return std::nullopt;
  }
  const year_month_day date{std::chrono::year{year}, std::chrono::month{month}, std::chrono::day{day}};
  if (!date.ok()) return std::nullopt;
  const auto time = sys_days{date} + hours{hour} + minutes{minute} + seconds{second};
  const std::int64_t whole_s = time.time_since_epoch().count();
  // Years 1678 to 2261: what 64 bits of nanoseconds hold.
  constexpr std::int64_t kMost_s = std::numeric_limits<std::int64_t>::max() / kSecond_ns - 1;
  if (std::abs(whole_s) > kMost_s) return std::nullopt;
  const std::int64_t value = whole_s * kSecond_ns + ns;
  if (iso_time(value) != text) return std::nullopt;
  return value;
}

}  // namespace stickslip::record
