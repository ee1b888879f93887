/// \file
/// The plan as JSON, with the names of the record.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"
#include "daemon/types/bench.hpp"
#include "daemon/types/quantity_json.hpp"

namespace stickslip::daemon {

[[nodiscard]] nlohmann::ordered_json plan_json(const Plan& plan);
/// Reads a plan. Absent or null keys stay unset. "pull_speed" is text with a unit, "pull_speed_m_per_s" a
/// number; a number as "pull_speed" is m/s, with a warning. "facts" is {"temperature": "23 degC", …}. Errors
/// (kUsage) name the key.
[[nodiscard]] base::Result<Plan> plan_of(const nlohmann::ordered_json& json, Warnings* warnings = nullptr);

/// Reads facts told as JSON text: {"temperature": "23 degC", "lot": null}; an empty text stands for null,
/// which removes a fact. Errors (kUsage) name the key.
[[nodiscard]] base::Result<std::map<std::string, std::string>> facts_in(std::string_view text);

/// Checks that a pull speed is above 0 and at most kFastestPull_m_per_s. \param key  named in the error.
/// Errors: kUsage.
[[nodiscard]] base::Result<void> check_pull_speed(std::string_view key, double speed_m_per_s);

}  // namespace stickslip::daemon
