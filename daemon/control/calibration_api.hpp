/// \file
/// The requests about the load cell's calibration. api.cpp checks name, Idempotency-Key and lease.
#pragma once

#include <functional>

#include "core/base/result.hpp"
#include "daemon/types/calibrator.hpp"
#include "daemon/types/http.hpp"
#include "daemon/types/quantity_json.hpp"

namespace stickslip::control {

/// A step of a calibration, ready to be carried out.
using CalibrationStep = std::function<void(daemon::Calibrator&, daemon::Calibrator::Answer)>;

/// Reads a step from a request. \param request  POST or DELETE /v1/calibration, or POST
/// /v1/calibration/weight, undo or finish. \param warnings  are added to. Errors (kUsage) say what is wrong
/// with its body.
[[nodiscard]] base::Result<CalibrationStep> calibration_step(const daemon::HttpRequest& request,
                                                             daemon::Warnings& warnings);

}  // namespace stickslip::control
