/// \file
/// Unit of a column of times, and the start of the trace.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "io/traces/import.hpp"
#include "io/traces/trace_table.hpp"

#include "core/base/result.hpp"

namespace stickslip::traces {

struct TimeUnit {
  std::string name;
  double seconds = 1.0;
  bool inspected = false;  ///< Nothing states it.
  std::string rates{};     ///< By inspection: the rate, and what other units would give, for people.
};

/// As base::parse_quantity() takes it: "ms" for "msec", "s" for "Sek." …
[[nodiscard]] std::string plain_time_unit(const std::string& unit);

/// Whether two units of a heading are one: "s" and "sec", "N" and "Newton".
[[nodiscard]] bool mean_the_same(const std::string& one, const std::string& other);
/// The unit that the request or the heading states; else the one in which rate and length are those of a
/// friction test. Errors: kUsage if the unit is no time, or if several units are possible.
[[nodiscard]] base::Result<TimeUnit> time_unit_of(const ImportRequest& request, const ColumnName& column,
                                                  const TraceTable& table);

/// Times since 1970 farther away than this have no 64 bits of ns: of the years 1684 to 2255.
inline constexpr double kFarthestEpoch_s = 9e9;

/// Start of the first row since 1970, ns, where the times tell; none beyond kFarthestEpoch_s.
/// Times of 1.2e10 s to 1.6e10 s are since 1601, as those of Windows.
[[nodiscard]] std::optional<std::int64_t> start_of(const TraceTable& table, double unit_s);

}  // namespace stickslip::traces
