#include "io/traces/time_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "io/traces/quantity_unit.hpp"

#include "core/base/quantity.hpp"
#include "core/base/wording.hpp"

namespace stickslip::traces {
namespace {

using base::Result;

/// A time column without a unit is read in the one of s, ms, µs and ns that gives a rate and a length between
/// these; friction tests are neither slower, faster, shorter nor longer.
constexpr double kSlowest_Hz = 5.0;
constexpr double kFastest_Hz = 20'000.0;
constexpr double kShortest_s = 1.0;
constexpr double kLongest_s = 3.0 * 3600.0;
/// Times since 1970 of the years 2001 to 2096.
constexpr double kEarliestEpoch_s = 1e9;
constexpr double kLatestEpoch_s = 4e9;
/// The FILETIME of Windows counts 100 ns since 1601; these are of the years 1981 to 2108.
constexpr double kEarliestFiletime = 1.2e17;
constexpr double kLatestFiletime = 1.6e17;
constexpr double kFiletime_s = 1e-7;
constexpr double k1601To1970_s = 11'644'473'600.0;
/// What the heading says, or its name: "millis".
std::string stated_time_unit(const ImportRequest& request, const ColumnName& column) {
  if (!request.time_unit.empty()) return request.time_unit;
  const std::string name = folded(column.name);
  if (name.starts_with("milli")) return "ms";
  if (name.starts_with("micros")) return "us";
  return plain_time_unit(column.unit);
}

}  // namespace

std::string plain_time_unit(const std::string& as_printed) {
  const std::string unit = folded(as_printed);
  if (unit == "s" || unit.starts_with("sec") || unit.starts_with("sek")) return "s";
  if (unit == "msec" || unit.starts_with("millisec")) return "ms";
  if (unit == "usec" || unit.starts_with("microsec")) return "us";
  if (unit == "hr" || unit == "hrs" || unit.starts_with("hour") || unit.starts_with("stunde")) return "h";
  return unit.starts_with("min") ? "min" : as_printed;
}

bool mean_the_same(const std::string& one, const std::string& other) {
  if (plain_time_unit(one) == plain_time_unit(other)) return true;
  const Result<QuantityUnit> first = quantity_unit(one);
  const Result<QuantityUnit> second = quantity_unit(other);
  return first && second && first->quantity == second->quantity && first->scale == second->scale;
}

Result<TimeUnit> time_unit_of(const ImportRequest& request, const ColumnName& column,
                              const TraceTable& table) {
  if (table.time_in_seconds) return TimeUnit{table.time_unit_in_cells ? "the units of its cells" : "s"};
  if (const std::string stated = stated_time_unit(request, column); !stated.empty()) {
    const auto seconds = base::parse_quantity("1 " + stated, base::Dimension::kTime);
    if (seconds) return TimeUnit{stated, *seconds};
    return base::usage_error("{}: the unit of the time is \"{}\": give --time-unit s, ms, us, ns, min or h",
                             request.path, base::one_line(stated, 20));
  }
  if (table.first_time > kEarliestFiletime && table.first_time < kLatestFiletime)
    return TimeUnit{"100 ns since 1601", kFiletime_s, true};
  const auto [low, high] = std::minmax_element(table.time.begin(), table.time.end());
  const double length = *high - *low;
  const double count = static_cast<double>(table.time.size() - 1);
  std::vector<TimeUnit> possible;
  std::string rates;
  for (const TimeUnit& unit : {TimeUnit{"s", 1.0, true}, TimeUnit{"ms", 1e-3, true},
                               TimeUnit{"us", 1e-6, true}, TimeUnit{"ns", 1e-9, true}}) {
    const double rate_Hz = count / (length * unit.seconds);
    const bool fits = request.rate_Hz
                          ? std::abs(std::log2(rate_Hz / *request.rate_Hz)) < 1.0
                          : rate_Hz >= kSlowest_Hz && rate_Hz <= kFastest_Hz &&
                                length * unit.seconds >= kShortest_s && length * unit.seconds <= kLongest_s;
    if (fits) possible.push_back(unit);
    // One that is not plausible but not absurd either may be meant all the same.
    if (fits) rates = fmt::format(": {:.4g} Hz", rate_Hz) + rates;
    if (!fits && rate_Hz >= 0.1 * kSlowest_Hz && rate_Hz <= 10.0 * kFastest_Hz)
      rates += fmt::format("; --time-unit {} would be {:.4g} Hz", unit.name, rate_Hz);
  }
  if (possible.size() == 1) {
    if (!request.rate_Hz) possible.front().rates = rates;
    return possible.front();
  }
  // A column that does not advance, and a rate that fits no unit, have messages of their own.
  if (!(length > 0.0) || request.rate_Hz) return TimeUnit{"s", 1.0, true};
  return base::usage_error(
      "{}: column \"{}\" does not say its unit; it runs at {:.4g} Hz in s, {:.4g} Hz in ms, {:.4g} Hz in us, "
      "{:.4g} Hz in ns: "
      "give --time-unit",
      request.path, base::one_line(column.text, 40), count / length, 1e3 * count / length,
      1e6 * count / length, 1e9 * count / length);
}

std::optional<std::int64_t> start_of(const TraceTable& table, double unit_s) {
  constexpr double kNanosecond = 1e-9;
  if (table.date_s && std::abs(static_cast<double>(*table.date_s) + table.first_time) > kFarthestEpoch_s)
    return std::nullopt;
  if (table.date_s) return *table.date_s * 1'000'000'000 + std::llround(table.first_time / kNanosecond);
  double since = table.first_time * unit_s;
  if (since > kFiletime_s * kEarliestFiletime && since < kFiletime_s * kLatestFiletime)
    since -= k1601To1970_s;
  if (since < kEarliestEpoch_s || since > kLatestEpoch_s) return std::nullopt;
  return std::llround(since / kNanosecond);
}

}  // namespace stickslip::traces
