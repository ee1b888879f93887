/// \file
/// Parsing of numbers with units, such as "12 in/min", into SI.
///
///     parse_quantity("12 in/min", Dimension::kSpeed)   → 0.00508 (m/s)
///     parse_quantity("2331 g", Dimension::kMass)       → 2.331 (kg)
///     parse_quantity("12", Dimension::kSpeed)          → error: "12" has no unit; allowed: m/s, …
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
};

/// The whole text as one finite decimal number: no blanks, no plus sign, no hexadecimal, no
/// inf or nan, no number outside the range of double.
[[nodiscard]] Result<double> parse_number(std::string_view text);

/// "number unit" (blanks between them optional) in SI units. A dimensionless quantity may stand
/// without a unit or in %, ppm. Micro is "u" or "µ", powers are "^2" or "²".
/// \return the value, or an error that names the text and the allowed units, without a place: the caller
/// prefixes file and key.
[[nodiscard]] Result<double> parse_quantity(std::string_view text, Dimension dimension);

/// Unit in which parse_quantity() returns; "1" if dimensionless.
[[nodiscard]] std::string_view si_unit(Dimension dimension) noexcept;

/// "2.331 kg", "0.3": the shortest text that parses back to the same value.
[[nodiscard]] std::string format_quantity(double value, Dimension dimension);

}  // namespace stickslip::base
