/// \file
/// The requests about the load cell's calibration; api.hpp has seen to names, repetitions and who has the
/// bench.
#pragma once

#include <functional>

#include "core/base/result.hpp"
#include "daemon/types/calibrator.hpp"
#include "daemon/types/http.hpp"

namespace stickslip::control {

/// One of its steps, read and checked.
using CalibrationStep = std::function<void(daemon::Calibrator&, daemon::Calibrator::Answer)>;

/// \param request  POST or DELETE /v1/calibration, or POST /v1/calibration/weight, undo or finish. Errors
/// (kUsage) say what is wrong with its body.
[[nodiscard]] base::Result<CalibrationStep> calibration_step(const daemon::HttpRequest& request);

}  // namespace stickslip::control
