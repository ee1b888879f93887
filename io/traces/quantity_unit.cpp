#include "io/traces/quantity_unit.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstddef>
#include <optional>

#include "io/traces/column_name.hpp"

#include "core/base/quantity.hpp"
#include "core/base/wording.hpp"

namespace stickslip::traces {
namespace {

/// The unit that a word means: words and the units of a weight in any case, such as "Kgf" or "lbF".
std::string of_word(std::string_view unit) {
  const std::string word = folded(unit);
  if (word == "newton" || word == "newtons") return "N";
  if (word == "volt" || word == "volts") return "V";
  if (word == "kp" || word == "kilopond") return "kgf";
  if (word == "lbs") return "lbf";
  return word == "gf" || word == "kgf" || word == "lbf" || word == "ozf" ? word : std::string{unit};
}

std::optional<QuantityUnit> known_unit(std::string_view unit) {
  if (unit == "coefficient" || unit == "1") return QuantityUnit{daq::RawQuantity::kCoefficient, 1.0};
  if (unit == "counts") return QuantityUnit{daq::RawQuantity::kCounts, 1.0};
  if (unit == "cN") return QuantityUnit{daq::RawQuantity::kForce_N, 0.01};
  if (unit == "daN") return QuantityUnit{daq::RawQuantity::kForce_N, 10.0};
  if (unit == "percent" || unit == "%") return QuantityUnit{daq::RawQuantity::kCoefficient, 0.01};
  const std::string one = "1 " + of_word(unit);
  if (const auto force = base::parse_quantity(one, base::Dimension::kForce))
    return QuantityUnit{daq::RawQuantity::kForce_N, *force};
  if (const auto voltage = base::parse_quantity(one, base::Dimension::kVoltage))
    return QuantityUnit{daq::RawQuantity::kVolts, *voltage};
  return std::nullopt;
}

}  // namespace

std::string force_unit(const std::string& unit) {
  if (known_unit(unit)) return unit;
  return folded(unit).starts_with("gram") ? "gf" : unit + "f";
}

base::Result<QuantityUnit> quantity_unit(std::string_view unit) {
  if (const auto known = known_unit(unit)) return *known;
  const std::string force = force_unit(std::string{unit});
  return base::usage_error(
      "--unit: \"{}\" is no unit of force; allowed: N, mN, cN, daN, kN, gf, kgf, lbf, ozf, V, mV, "
      "counts, coefficient, percent{}",
      base::one_line(unit, 20),
      known_unit(force) ? fmt::format(". A force shown in {} is in {}", unit, force) : "");
}

base::Result<CountScale> count_scale(std::string_view range, double volts_per_count) {
  constexpr std::string_view kTo = "..";
  const auto code = [](std::string_view text) -> std::optional<std::int64_t> {
    std::int64_t number = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool all = status == std::errc{} && end == text.data() + text.size();
    return all ? std::optional{number} : std::nullopt;
  };
  const std::size_t at = range.find(kTo);
  const auto lowest = code(range.substr(0, at));
  const auto highest = at == std::string_view::npos ? std::nullopt : code(range.substr(at + kTo.size()));
  constexpr std::int64_t kFarthest = std::int64_t{1} << 32;
  if (!lowest || !highest || *lowest >= *highest || *lowest < -kFarthest || *highest > kFarthest ||
      *highest - *lowest >= kFarthest) {
    return base::usage_error(
        "--count-range: \"{}\" is no range of at most 2^32 codes: give the codes at both rails of the "
        "converter, "
        "such as 0..65535 or -32768..32767",
        base::one_line(range, 40));
  }
  return CountScale{*lowest, *highest, volts_per_count};
}

}  // namespace stickslip::traces
