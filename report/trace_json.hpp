/// \file
/// What a page draws of one record.
#pragma once

#include <cstddef>

#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"
#include "core/record/record.hpp"

namespace stickslip::report {

/// Longest trace that a page holds whole; of a longer one the lowest and highest scan of each of half as many
/// equal parts of its time.
inline constexpr std::size_t kMostPointsOnPage = 20'000;

/// {"scan_count", "rate", "thinned", "force": {"time", "value"}, "slope": {"time", "value", "unit", "limit"},
///  "second": {"time", "value", "unit", "name"}, "cycles": {"time", "peak", "captured"},
///  "modes": [[from, to, "stick"|"slip"|"slide"], …], "transition"}.
/// The second channel is null where there is none, else its values are in mm/s (pull_speed) or mm
/// (sled_position). Times in s after the first scan, to the microsecond; coefficients to the millionth; null
/// is a break. Modes are those that the detector found: a slip that did not end in sticking slides until the
/// next onset, the last one of a ring-down until the force is taken away. Errors: as coefficient_trace().
[[nodiscard]] base::Result<nlohmann::ordered_json> trace_json(const record::Record& record);

}  // namespace stickslip::report
