/// \file
/// The data that a page draws of a record.
#pragma once

#include <cstddef>

#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"
#include "core/record/record.hpp"
#include "daemon/types/reports.hpp"

namespace stickslip::report {

/// Most points of a trace on a page. A longer trace is thinned: its time is divided into half as many equal
/// parts, and each part keeps its lowest and highest scan.
inline constexpr std::size_t kMostPointsOnPage = daemon::kMostTracePoints;

/// {"scan_count", "rate", "thinned", "force": {"time", "value"}, "slope": {"time", "value", "unit", "limit"},
///  "second": {"time", "value", "unit", "name"}, "cycles": {"time", "peak", "captured"},
///  "modes": [[from, to, "stick"|"slip"|"slide"], …], "transition"}.
/// Beside a "value" whose times are in equal steps stand "start" and "step" instead of "time".
/// "second" is null without a second channel; its values are in mm/s (pull_speed) or mm (sled_position).
/// Times are in s after the first scan, those that are listed rounded to 1e-6; coefficients are rounded to
/// 1e-6; null is a break. "modes" are the detected ones: a slip that did not end in sticking slides until the
/// next onset, the last slip of a ring-down until the force is released. Errors: as coefficient_trace().
[[nodiscard]] base::Result<nlohmann::ordered_json> trace_json(const record::Record& record);

}  // namespace stickslip::report
