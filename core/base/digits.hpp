/// \file
/// Number of digits with which a number is shown, and unit in which a speed is shown.
#pragma once

#include <string>
#include <string_view>

namespace stickslip::base {

/// Number of decimals with which a number rounded to `digits` significant digits is shown. For 2 digits: 3
/// for 0.0123, 0 for 12.3, −1 for 99.6, which rounds to 100.
/// \param number  > 0, finite. \param digits  ≥ 1.
[[nodiscard]] int decimals_of(double number, int digits);

/// Number of significant digits with which an uncertainty is shown [JCGM 100:2008, 7.2.6].
inline constexpr int kUncertaintyDigits = 2;

/// A unit of speed.
struct SpeedUnit {
  std::string_view symbol;
  double m_per_s = 1.0;  ///< One of this unit, m/s.

  /// The speed in this unit, with at most six significant digits: "12 in/min".
  [[nodiscard]] std::string text(double speed_m_per_s) const;
};

/// The unit in which a nominal speed was most likely typed: of in/min, mm/min, mm/s and m/s the one in which
/// it has the fewest significant digits, among equals the fewest characters, then the first. 0.00508 m/s is
/// 12 in/min, 0.0025 m/s is 150 mm/min.
[[nodiscard]] SpeedUnit unit_of_speed(double speed_m_per_s);

/// A nominal speed with its unit_of_speed(): "12 in/min".
[[nodiscard]] std::string speed_text(double speed_m_per_s);

}  // namespace stickslip::base
