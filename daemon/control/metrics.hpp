/// \file
/// The status as Prometheus reads it: text format 0.0.4
/// (https://prometheus.io/docs/instrumenting/exposition_formats/).
#pragma once

#include <string>

#include "daemon/types/status.hpp"

namespace stickslip::control {

inline constexpr const char* kMetricsType = "text/plain; version=0.0.4; charset=utf-8";

[[nodiscard]] std::string metrics_text(const daemon::Status& status);

}  // namespace stickslip::control
