/// \file
/// The plan as JSON, with the names of the record.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"
#include "daemon/types/bench.hpp"

namespace stickslip::daemon {

[[nodiscard]] nlohmann::ordered_json plan_json(const Plan& plan);
/// Reads a plan. Absent or null keys stay unset. "pull_speed" is a number in m/s, or text with a unit. Errors
/// (kUsage) name the key.
[[nodiscard]] base::Result<Plan> plan_of(const nlohmann::ordered_json& json);

/// Reads a speed above 0: a number in m/s, or text with a unit. \param key  named in the error. Errors:
/// kUsage.
[[nodiscard]] base::Result<double> pull_speed_of(std::string_view key, const nlohmann::ordered_json& value);

}  // namespace stickslip::daemon
