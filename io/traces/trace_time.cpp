#include "io/traces/trace_time.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <chrono>
#include <string>
#include <vector>

namespace stickslip::traces {
namespace {

/// A whole number of a few digits, all of the text.
std::optional<int> whole(std::string_view text) {
  int value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || text.size() > 4 || status != std::errc{} || end != text.data() + text.size() ||
      value < 0)
    return std::nullopt;
  return value;
}

std::vector<std::string_view> split(std::string_view text, char mark) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t at = text.find(mark);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

/// Takes "AM" or "PM" from the end. \return the letter; 0 if there is none.
char take_half(std::string_view& clock) {
  if (clock.size() < 2 || std::toupper(static_cast<unsigned char>(clock.back())) != 'M') return '\0';
  const auto half = static_cast<char>(std::toupper(static_cast<unsigned char>(clock[clock.size() - 2])));
  if (half != 'A' && half != 'P') return '\0';
  clock = trimmed(clock.substr(0, clock.size() - 2));
  return half;
}

/// "12:00:01.5", "00:01.5", "01:00:01.5 PM", "12:00:01:500"
std::optional<TimeCell> read_clock(std::string_view text, char decimal) {
  const char half = take_half(text);
  auto parts = split(text, ':');
  // Two digits would be frames.
  std::optional<int> thousandths;
  if (parts.size() == 4 && parts.back().size() == 3) {
    thousandths = whole(parts.back());
    if (!thousandths || !whole(parts[2])) return std::nullopt;
    parts.pop_back();
  }
  if (parts.size() < 2 || parts.size() > 3) return std::nullopt;
  TimeCell time;
  time.in_seconds = true;
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
    const auto part = whole(parts[i]);
    if (!part) return std::nullopt;
    time.value = 60.0 * (time.value + *part);
  }
  // Either mark stands before the fraction, whatever the other numbers of the file have.
  const char mark = parts.back().find(',') != std::string_view::npos   ? ','
                    : parts.back().find('.') != std::string_view::npos ? '.'
                                                                       : decimal;
  const Cell seconds = read_cell(parts.back(), mark);
  if (seconds.kind != CellKind::kNumber || !seconds.unit.empty() || seconds.value < 0.0 ||
      seconds.value >= 61.0)
    return std::nullopt;
  time.value += seconds.value + 1e-3 * thousandths.value_or(0);
  if (half != '\0') {
    constexpr double kHalf_s = 12.0 * 3600.0;
    if (parts.size() != 3 || time.value < 3600.0 || time.value >= kHalf_s + 3600.0) return std::nullopt;
    time.value += (time.value >= kHalf_s ? -kHalf_s : 0.0) + (half == 'P' ? kHalf_s : 0.0);
  }
  time.decimals = thousandths ? 3 : seconds.decimals;
  return time;
}

/// 1 of "Jan" or "January"; 0 of other words.
int month_of(std::string_view word) {
  constexpr std::array<std::string_view, 12> kMonths{"january",   "february", "march",    "april",
                                                     "may",       "june",     "july",     "august",
                                                     "september", "october",  "november", "december"};
  constexpr std::size_t kShortest = 3;
  if (word.size() < kShortest || is_digit(word.front())) return 0;
  const auto is_it = [word](std::string_view month) {
    return word.size() <= month.size() &&
           std::equal(word.begin(), word.end(), month.begin(),
                      [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
  };
  const auto found = std::find_if(kMonths.begin(), kMonths.end(), is_it);
  return found == kMonths.end() ? 0 : static_cast<int>(found - kMonths.begin()) + 1;
}

/// "2026-11-25", "25.11.2026", "25-Nov-2026", "Nov 25, 2026"
std::optional<std::int64_t> read_date(std::string_view text) {
  const std::size_t mark = text.find_first_of("./ -");
  if (mark == std::string_view::npos) return std::nullopt;
  auto parts = split(text, text[mark]);
  if (parts.size() != 3) return std::nullopt;
  if (month_of(parts[0]) > 0) std::swap(parts[0], parts[1]);
  if (parts[0].ends_with(',')) parts[0].remove_suffix(1);
  const int word = month_of(parts[1]);
  if ((text[mark] == '.' || word > 0) && parts[0].size() != 4) std::swap(parts[0], parts[2]);
  if (parts[0].size() != 4) return std::nullopt;
  const auto year = whole(parts[0]);
  const auto month = word > 0 ? std::optional{word} : whole(parts[1]);
  const auto day = whole(parts[2]);
  constexpr int kLastMonth = 12;
  constexpr int kLastDay = 31;
  // The calendar keeps eight bits of each.
  if (!year || !month || !day || *month > kLastMonth || *day > kLastDay) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year{*year},
                                         std::chrono::month{static_cast<unsigned>(*month)},
                                         std::chrono::day{static_cast<unsigned>(*day)}};
  if (!date.ok()) return std::nullopt;
  return std::chrono::duration_cast<std::chrono::seconds>(std::chrono::sys_days{date}.time_since_epoch())
      .count();
}

/// "11/25/2026" or "25/11/2026", "25.11.26" or "26-11-25": the order of day, month and year is not known. Of
/// a clock that was never set they are 0.
bool is_unclear_date(std::string_view text) {
  const std::size_t mark = text.find_first_of("/.-");
  if (mark == std::string_view::npos) return false;
  const auto parts = split(text, text[mark]);
  constexpr std::size_t kDateParts = 3;
  if (parts.size() != kDateParts || parts[0].size() > 2 || (text[mark] != '/' && parts[2].size() != 2))
    return false;
  int months = 0;
  int days = 0;
  for (const std::string_view part : parts) {
    const auto number = whole(part);
    if (!number) return false;
    months += *number <= 12 ? 1 : 0;
    days += *number <= 31 ? 1 : 0;
  }
  return months >= 1 && days >= 2;
}

/// Takes "Z", "+01:00" or nothing from the end. \return the offset in s; nothing if it is no offset.
std::optional<int> take_offset(std::string_view& clock) {
  if (clock.ends_with('Z')) {
    clock.remove_suffix(1);
    return 0;
  }
  const std::size_t at = clock.find_first_of("+-");
  if (at == std::string_view::npos) return 0;
  const auto parts = split(clock.substr(at + 1), ':');
  const auto hours = whole(parts[0].substr(0, 2));
  const auto minutes = parts.size() > 1       ? whole(parts[1])
                       : parts[0].size() == 4 ? whole(parts[0].substr(2))
                                              : std::optional{0};
  if (!hours || !minutes) return std::nullopt;
  const int sign = clock[at] == '-' ? -1 : 1;
  clock = clock.substr(0, at);
  return sign * (3600 * *hours + 60 * *minutes);
}

std::optional<TimeCell> read_moment(std::string_view text, char decimal) {
  // The last one before the clock, as the date may have words.
  const std::size_t colon = text.find(':');
  const std::size_t between = text.find_last_of("T ", colon);
  if (colon == std::string_view::npos || between == std::string_view::npos || between > colon)
    return std::nullopt;
  std::string_view day = trimmed(text.substr(0, between));
  if (day.size() > 1 && day.back() == 'T' && is_digit(day[day.size() - 2]))
    day = trimmed(day.substr(0, day.size() - 1));
  const auto date = read_date(day);
  std::string_view clock = trimmed(text.substr(between + 1));
  if (!date && is_unclear_date(day)) {
    auto time = read_clock(clock, decimal);
    if (time) time->unclear_date = day;
    return time;
  }
  const auto offset = take_offset(clock);
  if (!date || !offset) return std::nullopt;
  auto time = read_clock(clock, decimal);
  if (time) time->date_s = *date - *offset;
  return time;
}

}  // namespace

std::optional<TimeCell> read_time_cell(std::string_view text, char decimal) {
  return read_time_cell(text, read_cell(text, decimal), decimal);
}

std::optional<TimeCell> read_time_cell(std::string_view text, const Cell& cell, char decimal) {
  text = trimmed(text);
  if (cell.kind == CellKind::kNumber) {
    TimeCell time;
    time.value = cell.value;
    time.decimals = cell.decimals;
    return time;
  }
  if (auto time = read_moment(text, decimal)) return time;
  return read_clock(text, decimal);
}

}  // namespace stickslip::traces
