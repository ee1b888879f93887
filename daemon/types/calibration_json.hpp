/// \file
/// Calibrations of the load cell as JSON, with the names of the record.
#pragma once

#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"
#include "core/daq/gain_change.hpp"
#include "core/daq/weighed_calibration.hpp"
#include "daemon/types/calibrator.hpp"
#include "daemon/types/quantity_json.hpp"

namespace stickslip::daemon {

[[nodiscard]] nlohmann::ordered_json points_json(const daq::WeighedCalibration& weighed);
/// null if the value is absent, infinite or NaN.
[[nodiscard]] nlohmann::ordered_json known_json(std::optional<double> value);
/// {"code", "text", "gain", "gain_in_use", "ratio", "limit"}; null without a change.
[[nodiscard]] nlohmann::ordered_json gain_change_json(const std::optional<daq::GainChange>& change);
[[nodiscard]] nlohmann::ordered_json calibration_json(const CalibrationView& view);

// Readers of request bodies. Quantities are text with a unit ("settle": "1 s"), or a number under the key
// with the unit ("settle_s": 1). Errors (kUsage) name the key.

/// Longest settling and reading time of a weight.
inline constexpr double kLongestWeighing_s = 60.0;
/// Reads "settle" and "reading", each at most kLongestWeighing_s. A number as "settle" is s, with a warning.
[[nodiscard]] base::Result<daq::WeighingTimes> weighing_times_of(const nlohmann::ordered_json& json,
                                                                 Warnings* warnings = nullptr);
/// Reads "mass" or "mass_kg", in kg. A number as "mass" is refused unless it is 0.
[[nodiscard]] base::Result<double> mass_of(const nlohmann::ordered_json& json);
/// Reads "certificate", "valid_days" and "confirm".
[[nodiscard]] base::Result<io::CalibrationPaper> paper_of(const nlohmann::ordered_json& json);

}  // namespace stickslip::daemon
