/// \file
/// Calibrations of the load cell as JSON, with the names of the record.
#pragma once

#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"
#include "core/daq/weighed_calibration.hpp"
#include "daemon/types/calibrator.hpp"

namespace stickslip::daemon {

[[nodiscard]] nlohmann::ordered_json points_json(const daq::WeighedCalibration& weighed);
/// null if the value is absent, infinite or NaN.
[[nodiscard]] nlohmann::ordered_json known_json(std::optional<double> value);
[[nodiscard]] nlohmann::ordered_json calibration_json(const CalibrationView& view);

// Readers of request bodies. Quantities are numbers in SI units, or text with a unit. Errors (kUsage) name
// the key.

/// Longest settling and reading time of a weight.
inline constexpr double kLongestWeighing_s = 60.0;
/// Reads "settle" and "reading", each at most kLongestWeighing_s.
[[nodiscard]] base::Result<daq::WeighingTimes> weighing_times_of(const nlohmann::ordered_json& json);
/// Reads "mass", in kg.
[[nodiscard]] base::Result<double> mass_of(const nlohmann::ordered_json& json);
/// Reads "certificate" and "valid_days".
[[nodiscard]] base::Result<io::CalibrationPaper> paper_of(const nlohmann::ordered_json& json);

}  // namespace stickslip::daemon
