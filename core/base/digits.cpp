#include "core/base/digits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <utility>

namespace stickslip::base {
namespace {

constexpr double kInchShown_m = 0.0254;
constexpr std::array kShownSpeedUnits{SpeedUnit{"in/min", kInchShown_m / 60.0},
                                      SpeedUnit{"mm/min", 1e-3 / 60.0}, SpeedUnit{"mm/s", 1e-3},
                                      SpeedUnit{"m/s", 1.0}};

/// Conversion rounds by parts in 1e16; what was typed has fewer digits than these.
std::string number_of(double value) { return fmt::format("{:.6g}", value); }

/// Significant digits, then characters.
std::pair<std::size_t, std::size_t> length_of(const std::string& number) {
  std::string digits = number.substr(0, number.find('e'));
  digits.erase(std::remove_if(digits.begin(), digits.end(), [](char c) { return c < '0' || c > '9'; }),
               digits.end());
  const std::size_t first = digits.find_first_not_of('0');
  const std::size_t last = digits.find_last_not_of('0');
  return {first == std::string::npos ? 0 : last - first + 1, number.size()};
}

}  // namespace

int decimals_of(double number, int digits) {
  const std::string text = fmt::format("{:.{}e}", number, digits - 1);
  int exponent = 0;
  const char* first = text.data() + text.find('e') + 1;
  if (*first == '+') ++first;
  std::from_chars(first, text.data() + text.size(), exponent);
  return digits - 1 - exponent;
}

std::string SpeedUnit::text(double speed_m_per_s) const {
  return fmt::format("{} {}", number_of(speed_m_per_s / m_per_s), symbol);
}

SpeedUnit unit_of_speed(double speed_m_per_s) {
  const auto length = [speed_m_per_s](const SpeedUnit& unit) {
    return length_of(number_of(speed_m_per_s / unit.m_per_s));
  };
  return *std::min_element(
      kShownSpeedUnits.begin(), kShownSpeedUnits.end(),
      [&length](const SpeedUnit& one, const SpeedUnit& other) { return length(one) < length(other); });
}

std::string speed_text(double speed_m_per_s) { return unit_of_speed(speed_m_per_s).text(speed_m_per_s); }

}  // namespace stickslip::base
