/// \file
/// Parsing of numbers with units, such as "12 in/min", into SI.
///
///     parse_quantity("12 in/min", Dimension::kSpeed)   → 0.00508 (m/s)
///     parse_quantity("2331 g", Dimension::kMass)       → 2.331 (kg)
///     parse_quantity("12", Dimension::kSpeed)          → error: "12": a speed needs its unit, such as …
///
/// Factors: 1 in = 0.0254 m and 1 lb = 0.45359237 kg exactly [International yard and pound
/// agreement, 1959]; 1 kgf = 9.80665 N exactly [3rd CGPM, 1901]; the rest is SI [SI Brochure,
/// 9th ed., 2019].
#pragma once

#include <string>
#include <string_view>

#include "core/base/result.hpp"

namespace stickslip::base {

/// Physical dimension of a number. The comment of each is the SI unit of returned values.
enum class Dimension {
  kDimensionless,     ///< 1
  kTime,              ///< s
  kFrequency,         ///< Hz
  kAngularFrequency,  ///< rad/s
  kPerTime,           ///< 1/s
  kLength,            ///< m
  kArea,              ///< m^2
  kSpeed,             ///< m/s
  kAcceleration,      ///< m/s^2
  kJerk,              ///< m/s^3
  kMass,              ///< kg
  kForce,             ///< N
  kVoltage,           ///< V
  kStiffness,         ///< N/m
  kForcePerVoltage,   ///< N/V
  kVoltagePerForce,   ///< V/N
  kSpeedPerVoltage,   ///< m/s/V
  kLengthPerVoltage,  ///< m/V
  kTimePerLength,     ///< s/m
  kAngle,             ///< rad
  kTemperature,       ///< degC; the only one whose units have different zeros
};
inline constexpr Dimension kLastDimension = Dimension::kTemperature;

/// The whole text as one decimal number, with or without an exponent: no blanks, no plus sign before it, no
/// hexadecimal, no inf or nan, none too large or too small for a double (1e-400). All else is an error of
/// kind kUsage that names the text.
[[nodiscard]] Result<double> parse_number(std::string_view text);

/// "number unit" in SI units; blanks between and around them are optional. A dimensionless quantity may stand
/// without a unit or in %, ppm. Micro is "u" or "µ", degree is "deg" or "°", a square is "^2" or "²", a cube
/// only "^3".
/// \return the value, or an error of kind kUsage, which begins with the text in quotes and says what is wrong
/// or allowed, without a place: the caller prefixes file and key.
[[nodiscard]] Result<double> parse_quantity(std::string_view text, Dimension dimension);

/// What an entry (an option, a field of a request) does with a number that has no unit though its dimension
/// has some. A dimensionless number needs none.
enum class BareNumber {
  kRefused,        ///< Refused, as in configuration files.
  kOnlyZero,       ///< Refused but for 0; as a temperature 0 is refused, too.
  kSiWithWarning,  ///< Read in the SI unit, as version 0.1 did; EnteredQuantity::warning says so.
  kSi,             ///< Read in the SI unit, as the entry's help says.
};

struct EnteredQuantity {
  double value = 0.0;   ///< In SI units.
  std::string warning;  ///< For the user; empty: none.
};

/// parse_quantity(), but `bare` rules what becomes of a number without a unit. Errors as parse_quantity().
[[nodiscard]] Result<EnteredQuantity> enter_quantity(std::string_view text, Dimension dimension,
                                                     BareNumber bare);

/// "a mass needs its unit, such as "500 g" or "500 kg"". \param number  as typed, without a unit.
[[nodiscard]] std::string unit_needed(std::string_view number, Dimension dimension);

/// The dimension that has this SI unit, written as si_unit() gives it; kDimensionless for "1" and for any
/// other text, such as "mm".
[[nodiscard]] Dimension dimension_of_unit(std::string_view si_unit) noexcept;

/// Unit in which parse_quantity() returns; "1" if dimensionless.
[[nodiscard]] std::string_view si_unit(Dimension dimension) noexcept;

/// "2.331 kg", "0.3": the fewest digits that parse_quantity() reads back as the same value.
/// \param value  in SI units, finite.
[[nodiscard]] std::string format_quantity(double value, Dimension dimension);

}  // namespace stickslip::base
