#include "io/catalogue/moment.hpp"

#include <fmt/format.h>

#include <array>
#include <ctime>
#include <optional>
#include <regex>

#include "core/base/wording.hpp"

namespace stickslip::catalogue {
namespace {

constexpr std::int64_t kNsInSecond = 1'000'000'000;
constexpr int kSecondsInMinute = 60;
constexpr int kMinutesInHour = 60;
/// Nanoseconds since 1970 fit 64 bits from 1677 to 2262.
constexpr int kFirstYear = 1700;
constexpr int kLastYear = 2200;

/// Seconds since 1970; nothing for a day or time that there is not. \param offset_s  east of UTC; absent:
/// local.
std::optional<std::int64_t> seconds_of(const std::tm& typed, std::optional<int> offset_s) {
  std::tm made = typed;
  made.tm_isdst = -1;
  const std::time_t seconds = offset_s ? ::timegm(&made) : std::mktime(&made);
  // A time that summer time leaves out is moved by its hour; 30 February becomes another day.
  if (made.tm_mday != typed.tm_mday || made.tm_mon != typed.tm_mon || made.tm_min != typed.tm_min)
    return std::nullopt;
  return static_cast<std::int64_t>(seconds) - offset_s.value_or(0);
}

}  // namespace

base::Result<Moment> moment_from_text(const std::string& text, const std::string& place) {
  static const std::regex form{
      R"((\d{4})-(\d\d)-(\d\d)(?:[T ](\d\d):(\d\d)(?::(\d\d))?(Z|[+-]\d\d:?\d\d)?)?)"};
  std::smatch match;
  const auto number = [&match](std::size_t group) {
    return match[group].matched ? std::stoi(match[group]) : 0;
  };
  if (std::regex_match(text, match, form)) {
    const std::array<int, 6> typed{number(1), number(2), number(3), number(4), number(5), number(6)};
    if (typed[0] < kFirstYear || typed[0] > kLastYear) {
      return base::usage_error("{} {}: the year must be {} to {}", place, base::one_line(text), kFirstYear,
                               kLastYear);
    }
    std::tm begin{};
    begin.tm_year = typed[0] - 1900;
    begin.tm_mon = typed[1] - 1;
    begin.tm_mday = typed[2];
    begin.tm_hour = typed[3];
    begin.tm_min = typed[4];
    begin.tm_sec = typed[5];
    std::optional<int> offset_s;
    if (const std::string zone = match[7]; !zone.empty()) {
      offset_s = 0;
      if (zone != "Z") {
        const int minutes =
            std::stoi(zone.substr(1, 2)) * kMinutesInHour + std::stoi(zone.substr(zone.size() - 2));
        offset_s = (zone[0] == '-' ? -minutes : minutes) * kSecondsInMinute;
      }
    }
    const auto first = seconds_of(begin, offset_s);
    if (first && typed[3] < 24 && typed[4] < 60 && typed[5] < 60) {
      std::int64_t end = *first + (match[6].matched ? 1 : kSecondsInMinute);
      if (!match[4].matched) {  // A day has 23, 24 or 25 hours.
        std::tm next = begin;
        ++next.tm_mday;
        next.tm_isdst = -1;
        end = static_cast<std::int64_t>(std::mktime(&next));
      }
      return Moment{*first * kNsInSecond, end * kNsInSecond};
    }
  }
  return base::usage_error(
      "{} {}: is no day or time; write it as 2026-11-21, 2026-11-21T12:53 (local time) or "
      "2026-11-21T12:53:02Z",
      place, base::one_line(text));
}

std::string local_minute(std::int64_t realtime_ns) {
  const std::time_t seconds = realtime_ns / kNsInSecond - (realtime_ns % kNsInSecond < 0 ? 1 : 0);
  std::tm local{};
  if (::localtime_r(&seconds, &local) == nullptr) return {};
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}", local.tm_year + 1900, local.tm_mon + 1, local.tm_mday,
                     local.tm_hour, local.tm_min);
}

}  // namespace stickslip::catalogue
