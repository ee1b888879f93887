/// \file
/// The requests about the load cell's calibration; api.hpp has seen to names, repetitions and who has the
/// bench.
#pragma once

#include <functional>

#include "core/base/result.hpp"
#include "daemon/control/calibrator.hpp"
#include "daemon/control/http.hpp"

namespace stickslip::daemon {

/// One of its steps, read and checked.
using CalibrationStep = std::function<void(Calibrator&, Calibrator::Answer)>;

/// \param request  POST or DELETE /v1/calibration, or POST /v1/calibration/weight, undo or finish. Errors
/// (kUsage) say what is wrong with its body.
[[nodiscard]] base::Result<CalibrationStep> calibration_step(const HttpRequest& request);

}  // namespace stickslip::daemon
