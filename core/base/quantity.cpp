#include "core/base/quantity.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <span>
#include <system_error>

#include <boost/algorithm/string/replace.hpp>

#include "core/base/wording.hpp"

namespace stickslip::base {
namespace {

/// SI value = number · numerator / denominator + zero. Two exact integers where possible, so that
/// "2331 g" is the double nearest to 2.331 (a factor of 0.001 would round twice).
struct Unit {
  std::string_view symbol;
  double numerator;
  double denominator;
  double zero = 0.0;  ///< SI value of 0 in this unit.
};

constexpr double kInch_m = 0.0254;
constexpr double kFoot_m = 0.3048;
constexpr double kPound_kg = 0.45359237;
constexpr double kKilogramForce_N = 9.80665;
/// 1 lbf = 0.45359237 kg · 9.80665 m/s², exactly.
constexpr double kPoundForce_N = 4.4482216152605;

// The first unit of each table is the SI unit.
constexpr std::array kDimensionlessUnits{Unit{"1", 1, 1}, Unit{"%", 1, 100}, Unit{"ppm", 1, 1e6}};
constexpr std::array kTimeUnits{Unit{"s", 1, 1},    Unit{"ms", 1, 1e3}, Unit{"us", 1, 1e6},
                                Unit{"ns", 1, 1e9}, Unit{"min", 60, 1}, Unit{"h", 3600, 1}};
constexpr std::array kFrequencyUnits{Unit{"Hz", 1, 1}, Unit{"mHz", 1, 1e3}, Unit{"kHz", 1e3, 1},
                                     Unit{"MHz", 1e6, 1}};
constexpr std::array kAngularFrequencyUnits{Unit{"rad/s", 1, 1}, Unit{"deg/s", std::numbers::pi, 180}};
constexpr std::array kPerTimeUnits{Unit{"1/s", 1, 1}, Unit{"1/min", 1, 60}, Unit{"1/h", 1, 3600},
                                   Unit{"%/s", 1, 100}, Unit{"ppm/s", 1, 1e6}};
constexpr std::array kLengthUnits{Unit{"m", 1, 1},    Unit{"cm", 1, 100},     Unit{"mm", 1, 1e3},
                                  Unit{"um", 1, 1e6}, Unit{"in", kInch_m, 1}, Unit{"ft", kFoot_m, 1}};
constexpr std::array kAreaUnits{Unit{"m^2", 1, 1}, Unit{"cm^2", 1, 1e4}, Unit{"mm^2", 1, 1e6},
                                Unit{"in^2", 64516, 1e8}};
constexpr std::array kSpeedUnits{Unit{"m/s", 1, 1},           Unit{"cm/s", 1, 100},
                                 Unit{"mm/s", 1, 1e3},        Unit{"um/s", 1, 1e6},
                                 Unit{"m/min", 1, 60},        Unit{"cm/min", 1, 6000},
                                 Unit{"mm/min", 1, 60'000},   Unit{"in/s", kInch_m, 1},
                                 Unit{"in/min", kInch_m, 60}, Unit{"ft/min", kFoot_m, 60}};
constexpr std::array kAccelerationUnits{Unit{"m/s^2", 1, 1}, Unit{"cm/s^2", 1, 100}, Unit{"mm/s^2", 1, 1e3},
                                        Unit{"in/s^2", kInch_m, 1}, Unit{"ft/s^2", kFoot_m, 1}};
constexpr std::array kJerkUnits{Unit{"m/s^3", 1, 1}, Unit{"cm/s^3", 1, 100}, Unit{"mm/s^3", 1, 1e3},
                                Unit{"in/s^3", kInch_m, 1}, Unit{"ft/s^3", kFoot_m, 1}};
constexpr std::array kMassUnits{Unit{"kg", 1, 1}, Unit{"g", 1, 1e3}, Unit{"mg", 1, 1e6},
                                Unit{"lb", kPound_kg, 1}};
constexpr std::array kForceUnits{Unit{"N", 1, 1},
                                 Unit{"mN", 1, 1e3},
                                 Unit{"kN", 1e3, 1},
                                 Unit{"gf", kKilogramForce_N, 1e3},
                                 Unit{"kgf", kKilogramForce_N, 1},
                                 Unit{"lbf", kPoundForce_N, 1},
                                 Unit{"ozf", kPoundForce_N, 16}};
constexpr std::array kVoltageUnits{Unit{"V", 1, 1}, Unit{"mV", 1, 1e3}, Unit{"uV", 1, 1e6}};
constexpr std::array kStiffnessUnits{Unit{"N/m", 1, 1}, Unit{"N/mm", 1e3, 1}, Unit{"kN/m", 1e3, 1},
                                     Unit{"lbf/in", kPoundForce_N, kInch_m}};
constexpr std::array kForcePerVoltageUnits{Unit{"N/V", 1, 1}, Unit{"mN/V", 1, 1e3}, Unit{"N/mV", 1e3, 1},
                                           Unit{"kgf/V", kKilogramForce_N, 1},
                                           Unit{"lbf/V", kPoundForce_N, 1}};
constexpr std::array kVoltagePerForceUnits{Unit{"V/N", 1, 1}, Unit{"mV/N", 1, 1e3},
                                           Unit{"V/kgf", 1, kKilogramForce_N},
                                           Unit{"V/lbf", 1, kPoundForce_N}};
constexpr std::array kSpeedPerVoltageUnits{Unit{"m/s/V", 1, 1}, Unit{"mm/s/V", 1, 1e3},
                                           Unit{"mm/min/V", 1, 60'000}, Unit{"in/min/V", kInch_m, 60}};
constexpr std::array kLengthPerVoltageUnits{Unit{"m/V", 1, 1}, Unit{"cm/V", 1, 100}, Unit{"mm/V", 1, 1e3},
                                            Unit{"in/V", kInch_m, 1}};
constexpr std::array kTimePerLengthUnits{Unit{"s/m", 1, 1}, Unit{"s/cm", 100, 1}, Unit{"s/mm", 1e3, 1},
                                         Unit{"s/in", 1, kInch_m}, Unit{"min/in", 60, kInch_m}};
constexpr std::array kAngleUnits{Unit{"rad", 1, 1}, Unit{"deg", std::numbers::pi, 180}};
/// 0 K = −273.15 °C and 0 °F = −160/9 °C, exactly.
constexpr std::array kTemperatureUnits{Unit{"degC", 1, 1}, Unit{"K", 1, 1, -273.15},
                                       Unit{"degF", 5, 9, -160.0 / 9}};

std::span<const Unit> units_of(Dimension dimension) noexcept {
  switch (dimension) {
    case Dimension::kDimensionless:
      return kDimensionlessUnits;
    case Dimension::kTime:
      return kTimeUnits;
    case Dimension::kFrequency:
      return kFrequencyUnits;
    case Dimension::kAngularFrequency:
      return kAngularFrequencyUnits;
    case Dimension::kPerTime:
      return kPerTimeUnits;
    case Dimension::kLength:
      return kLengthUnits;
    case Dimension::kArea:
      return kAreaUnits;
    case Dimension::kSpeed:
      return kSpeedUnits;
    case Dimension::kAcceleration:
      return kAccelerationUnits;
    case Dimension::kJerk:
      return kJerkUnits;
    case Dimension::kMass:
      return kMassUnits;
    case Dimension::kForce:
      return kForceUnits;
    case Dimension::kVoltage:
      return kVoltageUnits;
    case Dimension::kStiffness:
      return kStiffnessUnits;
    case Dimension::kForcePerVoltage:
      return kForcePerVoltageUnits;
    case Dimension::kVoltagePerForce:
      return kVoltagePerForceUnits;
    case Dimension::kSpeedPerVoltage:
      return kSpeedPerVoltageUnits;
    case Dimension::kLengthPerVoltage:
      return kLengthPerVoltageUnits;
    case Dimension::kTimePerLength:
      return kTimePerLengthUnits;
    case Dimension::kAngle:
      return kAngleUnits;
    case Dimension::kTemperature:
      return kTemperatureUnits;
  }
  return kDimensionlessUnits;
}

/// A dimension in words, and two of its units that people confuse.
struct Words {
  std::string_view name;
  std::string_view one_unit;
  std::string_view other_unit;
};

Words words_of(Dimension dimension) noexcept {
  switch (dimension) {
    case Dimension::kDimensionless:
      return {"a ratio", "1", "%"};
    case Dimension::kTime:
      return {"a time", "s", "ms"};
    case Dimension::kFrequency:
      return {"a frequency", "Hz", "kHz"};
    case Dimension::kAngularFrequency:
      return {"an angular frequency", "rad/s", "deg/s"};
    case Dimension::kPerTime:
      return {"a rate", "1/s", "1/min"};
    case Dimension::kLength:
      return {"a length", "mm", "m"};
    case Dimension::kArea:
      return {"an area", "cm^2", "m^2"};
    case Dimension::kSpeed:
      return {"a speed", "mm/min", "m/s"};
    case Dimension::kAcceleration:
      return {"an acceleration", "mm/s^2", "m/s^2"};
    case Dimension::kJerk:
      return {"a jerk", "mm/s^3", "m/s^3"};
    case Dimension::kMass:
      return {"a mass", "g", "kg"};
    case Dimension::kForce:
      return {"a force", "N", "gf"};
    case Dimension::kVoltage:
      return {"a voltage", "V", "mV"};
    case Dimension::kStiffness:
      return {"a stiffness", "N/m", "N/mm"};
    case Dimension::kForcePerVoltage:
      return {"a force per voltage", "N/V", "kgf/V"};
    case Dimension::kVoltagePerForce:
      return {"a voltage per force", "V/N", "mV/N"};
    case Dimension::kSpeedPerVoltage:
      return {"a speed per voltage", "m/s/V", "mm/min/V"};
    case Dimension::kLengthPerVoltage:
      return {"a length per voltage", "m/V", "mm/V"};
    case Dimension::kTimePerLength:
      return {"a time per length", "s/m", "s/mm"};
    case Dimension::kAngle:
      return {"an angle", "rad", "deg"};
    case Dimension::kTemperature:
      return {"a temperature", "degC", "degF"};
  }
  return {"a quantity", "1", "%"};
}

std::string allowed_units(Dimension dimension) {
  std::string list = dimension == Dimension::kDimensionless ? "no unit" : "";
  for (const Unit& unit : units_of(dimension)) {
    if (unit.symbol == "1") continue;
    if (!list.empty()) list += ", ";
    list += unit.symbol;
  }
  return list;
}

constexpr bool is_blank(char c) noexcept { return c == ' ' || c == '\t'; }

std::string_view trimmed(std::string_view text) noexcept {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// "µ" exists twice in Unicode (U+00B5, U+03BC); "°" is "deg".
std::string plain_symbol(std::string_view symbol) {
  std::string plain{symbol};
  boost::algorithm::replace_all(plain, "\u00B5", "u");
  boost::algorithm::replace_all(plain, "\u03BC", "u");
  boost::algorithm::replace_all(plain, "\u00B2", "^2");
  boost::algorithm::replace_all(plain, "\u00B0", "deg");
  return plain;
}

struct LeadingNumber {
  double value = 0.0;
  std::string_view rest;
  std::errc error{};
};

/// The longest decimal number at the start; error if there is none or it is no finite double.
LeadingNumber leading_number(std::string_view text) noexcept {
  LeadingNumber result;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, result.value, std::chars_format::general);
  result.error = error;
  if (error == std::errc{} && !std::isfinite(result.value)) result.error = std::errc::invalid_argument;
  result.rest = std::string_view{stop, static_cast<std::size_t>(end - stop)};
  return result;
}

}  // namespace

Result<double> parse_number(std::string_view text) {
  const LeadingNumber number = leading_number(text);
  if (number.error == std::errc::result_out_of_range) {
    return usage_error("\"{}\" is outside the range of numbers", text);
  }
  if (number.error != std::errc{} || !number.rest.empty()) {
    return usage_error("\"{}\" is not a decimal number", text);
  }
  return number.value;
}

Result<double> parse_quantity(std::string_view text, Dimension dimension) {
  const LeadingNumber number = leading_number(trimmed(text));
  if (number.error == std::errc::result_out_of_range) {
    return usage_error("\"{}\" is outside the range of numbers", text);
  }
  if (number.error != std::errc{}) {
    return usage_error("\"{}\" does not begin with a decimal number; write a number and one of: {}", text,
                       allowed_units(dimension));
  }
  const std::string symbol = plain_symbol(trimmed(number.rest));
  if (symbol.empty()) {
    if (dimension == Dimension::kDimensionless) return number.value;
    return usage_error("\"{}\": {}", text, unit_needed(trimmed(text), dimension));
  }
  for (const Unit& unit : units_of(dimension)) {
    if (unit.symbol != symbol) continue;
    const double value = number.value * unit.numerator / unit.denominator + unit.zero;
    if (!std::isfinite(value)) return usage_error("\"{}\" is outside the range of numbers", text);
    return value;
  }
  if (const std::string_view rest = trimmed(number.rest);
      rest.size() > 1 && rest.front() == ',' && rest[1] >= '0' && rest[1] <= '9') {
    std::string point{text};
    point[point.find(',')] = '.';
    return usage_error("\"{}\" has a comma: the decimal sign is a point: write \"{}\"", text,
                       one_line(point));
  }
  return usage_error("\"{}\" has the unit \"{}\"; allowed: {}", text, one_line(symbol),
                     allowed_units(dimension));
}

Result<EnteredQuantity> enter_quantity(std::string_view text, Dimension dimension, BareNumber bare) {
  const std::string_view number = trimmed(text);
  const Result<double> value = parse_number(number);
  const bool accepted =
      bare == BareNumber::kSi || bare == BareNumber::kSiWithWarning ||
      (bare == BareNumber::kOnlyZero && dimension != Dimension::kTemperature && value && *value == 0.0);
  if (!value || !accepted || dimension == Dimension::kDimensionless) {
    const Result<double> parsed = parse_quantity(text, dimension);
    if (!parsed) return tl::unexpected(parsed.error());
    return EnteredQuantity{*parsed, {}};
  }
  if (bare != BareNumber::kSiWithWarning) return EnteredQuantity{*value, {}};
  return EnteredQuantity{*value, fmt::format("\"{0}\": {1} needs its unit; it is read as \"{0} {2}\": write "
                                             "that, as the next version refuses a number alone",
                                             number, words_of(dimension).name, si_unit(dimension))};
}

std::string unit_needed(std::string_view number, Dimension dimension) {
  const auto [name, one_unit, other_unit] = words_of(dimension);
  return fmt::format("{0} needs its unit, such as \"{1} {2}\" or \"{1} {3}\"", name, number, one_unit,
                     other_unit);
}

Dimension dimension_of_unit(std::string_view unit) noexcept {
  for (int i = 0; i <= static_cast<int>(kLastDimension); ++i) {
    const auto dimension = static_cast<Dimension>(i);
    if (si_unit(dimension) == unit) return dimension;
  }
  return Dimension::kDimensionless;
}

std::string_view si_unit(Dimension dimension) noexcept { return units_of(dimension).front().symbol; }

std::string format_quantity(double value, Dimension dimension) {
  if (dimension == Dimension::kDimensionless) return fmt::format("{}", value);
  return fmt::format("{} {}", value, si_unit(dimension));
}

}  // namespace stickslip::base
