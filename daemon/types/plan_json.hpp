/// \file
/// The plan as JSON, by the names of the record.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"
#include "daemon/types/bench.hpp"

namespace stickslip::daemon {

[[nodiscard]] nlohmann::ordered_json plan_json(const Plan& plan);
/// What is absent or null is not said. pull_speed is m/s, or text with a unit. Errors (kUsage) name the key.
[[nodiscard]] base::Result<Plan> plan_of(const nlohmann::ordered_json& json);

/// A speed above 0: a number in m/s, or text with a unit. \param key  for the error.
[[nodiscard]] base::Result<double> pull_speed_of(std::string_view key, const nlohmann::ordered_json& value);

}  // namespace stickslip::daemon
