#include "io/traces/cell.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>

namespace stickslip::traces {
namespace {

constexpr std::string_view kMinus = "\xE2\x88\x92";        // U+2212.
constexpr std::string_view kNoBreakSpace = "\xC2\xA0";     // U+00A0.
constexpr std::string_view kNarrowSpace = "\xE2\x80\xAF";  // U+202F.
/// Longest number and longest unit behind it, bytes.
constexpr std::size_t kLongestNumber = 40;
constexpr std::size_t kLongestUnit = 8;

/// In lower case. Instruments write them for overload, no reading and no channel.
constexpr std::array<std::string_view, 30> kHoles{
    "nan",       "-nan",     "na",        "n/a",          "null",          "none",
    "-",         "--",       "---",       "ovld",         "ovl",           "ol",
    "+ol",       "-ol",      "over",      "inf",          "+inf",          "-inf",
    "-nan(ind)", "nan(ind)", "overload",  "infinity",     "+infinity",     "-infinity",
    "overrange", "overflow", "underflow", "\xE2\x88\x9E", "+\xE2\x88\x9E", "-\xE2\x88\x9E"};
/// Infinity and not a number in the numbers of instruments [SCPI-99, 7.2.1].
constexpr double kScpiInfinity = 9.9e37;
constexpr double kScpiNaN = 9.91e37;
constexpr std::size_t kLongestHole = 9;
/// Between groups of three digits, in any language.
constexpr std::array<std::string_view, 6> kThousands{" ", kNoBreakSpace, kNarrowSpace, "\xE2\x80\x89",
                                                     "'", "\xE2\x80\x99"};

bool is_hole(std::string_view text) {
  // A number that is wider than its field, in C and Fortran.
  if (text.size() > 1 && text.find_first_not_of('*') == std::string_view::npos) return true;
  if (text.size() > kLongestHole) return false;
  // Errors of spreadsheets, "#DIV/0!", and of an old C library, "-1.#IND".
  if (text.starts_with('#') ||
      (text.find('#') != std::string_view::npos && text.find("1.#") != std::string_view::npos))
    return true;
  const std::size_t sign = text.front() == '-' || text.front() == '+' ? 1 : 0;
  if (text.size() > sign && is_digit(text[sign])) return false;
  std::array<char, kLongestHole> lower{};
  std::transform(text.begin(), text.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kHoles.begin(), kHoles.end(), std::string_view{lower.data(), text.size()}) != kHoles.end();
}

/// \param number  of Digits::text.
int decimals_of(std::string_view number) {
  const std::size_t exponent = number.find('e');
  const std::string_view mantissa = number.substr(0, exponent);
  const std::size_t point = mantissa.find('.');
  int decimals = point == std::string_view::npos ? 0 : static_cast<int>(mantissa.size() - point - 1);
  if (exponent != std::string_view::npos) {
    const char* begin = number.data() + exponent + 1;
    if (begin != number.data() + number.size() && *begin == '+') ++begin;
    int power = 0;
    std::from_chars(begin, number.data() + number.size(), power);
    decimals -= power;
  }
  return decimals;
}

/// The number at the beginning, with '.' as decimal mark and without marks of thousands.
struct Digits {
  std::array<char, kLongestNumber> text{};
  std::size_t size = 0;
  std::size_t taken = 0;   ///< Bytes of the cell.
  bool whole = true;       ///< It fits.
  bool one_group = false;  ///< As Cell.
};

/// "0,005" has no mark of thousands: a group in front of one never begins with 0.
bool zero_first(const Digits& digits) noexcept {
  return digits.text[digits.size > 0 && digits.text[0] == '-' ? 1 : 0] == '0';
}

Digits digits_in(std::string_view text, char decimal) {
  const std::string_view other = decimal == '.' ? "," : ".";
  std::string_view thousands;  // The mark, once there is one.
  Digits digits;
  const auto add = [&digits](char c) {
    digits.whole = digits.whole && digits.size < kLongestNumber;
    if (digits.whole) digits.text[digits.size++] = c;
  };
  std::size_t at = 0;
  if (text.starts_with(kMinus)) {
    add('-');
    at = kMinus.size();
  } else if (text.starts_with('+') || text.starts_with('-')) {
    if (text.front() == '-') add('-');
    at = 1;
  }
  bool point = false;
  bool grouped = false;
  int marks = 0;          // Of thousands.
  std::size_t group = 0;  // Digits since the last mark of thousands or the sign.
  const auto mark_at = [&](std::size_t place) -> std::string_view {
    const std::string_view rest = text.substr(place);
    if (!thousands.empty()) return rest.starts_with(thousands) ? thousands : std::string_view{};
    if (rest.starts_with(other)) return other;
    for (const std::string_view mark : kThousands) {
      if (rest.starts_with(mark)) return mark;
    }
    return {};
  };
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (is_digit(c)) {
      add(c);
      group += point ? 0 : 1;
    } else if (c == decimal && !point && (!grouped || group == 3)) {
      add('.');
      point = true;
    } else if (const std::string_view mark = mark_at(at);
               !mark.empty() && !point && group > 0 && group <= 3 &&
               (grouped ? group == 3 : !zero_first(digits)) && text.size() >= at + mark.size() + 3 &&
               std::all_of(text.begin() + static_cast<std::ptrdiff_t>(at + mark.size()),
                           text.begin() + static_cast<std::ptrdiff_t>(at + mark.size()) + 3, is_digit)) {
      thousands = mark;
      grouped = true;
      ++marks;
      group = 0;
      at += mark.size() - 1;
    } else {
      break;
    }
  }
  // Fortran writes doubles as 1.0D+02, always with point and sign.
  const bool fortran = point && at + 1 < text.size() && (text[at] == 'd' || text[at] == 'D') &&
                       (text[at + 1] == '+' || text[at + 1] == '-');
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E' || fortran)) {
    std::size_t end = at + 1;
    if (end < text.size() && (text[end] == '+' || text[end] == '-')) ++end;
    if (end < text.size() && is_digit(text[end])) {
      add('e');
      for (++at; at < text.size() && (at < end || is_digit(text[at])); ++at) {
        if (text[at] != '+') add(text[at]);
      }
    }
  }
  digits.taken = at;
  digits.one_group = marks == 1 && !point && thousands == other;
  digits.whole = digits.whole && (!grouped || point || group == 3);
  return digits;
}

}  // namespace

std::string_view trimmed(std::string_view text) noexcept {
  const auto is_plain = [](char c) { return c > ' ' && c <= '~'; };
  if (text.empty() || (is_plain(text.front()) && is_plain(text.back()))) return text;
  const auto drop = [&text](std::string_view blank, bool front) {
    if (front ? !text.starts_with(blank) : !text.ends_with(blank)) return false;
    front ? text.remove_prefix(blank.size()) : text.remove_suffix(blank.size());
    return true;
  };
  for (const bool front : {true, false}) {
    while (drop(" ", front) || drop("\t", front) || drop("\n", front) || drop("\r", front) ||
           drop(kNoBreakSpace, front) || drop(kNarrowSpace, front)) {
    }
  }
  return text;
}

Cell read_cell(std::string_view text, char decimal) {
  text = trimmed(text);
  Cell cell;
  if (text.empty()) return cell;
  if (is_hole(text)) {
    cell.kind = CellKind::kHole;
    return cell;
  }
  cell.kind = CellKind::kText;
  const Digits digits = digits_in(text, decimal);
  const char* const begin = digits.text.data();
  double value = 0.0;
  const auto [end, status] = std::from_chars(begin, begin + digits.size, value);
  if (!digits.whole || digits.size == 0 || end != begin + digits.size || status != std::errc{} ||
      !std::isfinite(value)) {
    return cell;
  }
  const std::string_view rest = trimmed(text.substr(digits.taken));
  if (rest.size() > kLongestUnit || std::any_of(rest.begin(), rest.end(), is_digit) ||
      rest.find_first_of(",.;:-") != std::string_view::npos ||
      std::any_of(rest.begin(), rest.end(), [](unsigned char c) { return c < ' '; })) {
    return cell;
  }
  if (std::abs(value) == kScpiInfinity || std::abs(value) == kScpiNaN) {
    cell.kind = CellKind::kHole;
    return cell;
  }
  cell.kind = CellKind::kNumber;
  cell.value = value;
  cell.decimals = decimals_of({begin, digits.size});
  cell.unit = rest;
  cell.one_group = digits.one_group;
  return cell;
}

}  // namespace stickslip::traces
