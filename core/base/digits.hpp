/// \file
/// How many digits a number is shown with, and the unit in which a speed is.
#pragma once

#include <string>
#include <string_view>

namespace stickslip::base {

/// Decimals that show `digits` significant digits of a positive number, once it is rounded to them; negative
/// from 10^digits on. \param number  > 0, finite.
[[nodiscard]] int decimals_of(double number, int digits);

/// Significant digits of an uncertainty [JCGM 100:2008, 7.2.6].
inline constexpr int kUncertaintyDigits = 2;

/// A unit of speed.
struct SpeedUnit {
  std::string_view symbol;
  double m_per_s = 1.0;  ///< One of it.

  /// "12 in/min": at most six significant digits.
  [[nodiscard]] std::string text(double speed_m_per_s) const;
};

/// The unit in which a nominal speed has the fewest digits, as it was most likely typed: 0.00508 m/s is 12
/// in/min, 0.0025 m/s 150 mm/min. Of in/min, mm/min, mm/s and m/s; what is equally short in two has the
/// first.
[[nodiscard]] SpeedUnit unit_of_speed(double speed_m_per_s);

/// A nominal speed in unit_of_speed().
[[nodiscard]] std::string speed_text(double speed_m_per_s);

}  // namespace stickslip::base
