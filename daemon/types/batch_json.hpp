/// \file
/// Batches as JSON, for the control interface and for the lines of the batch journal.
#pragma once

#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"
#include "daemon/types/batch.hpp"
#include "daemon/types/quantity_json.hpp"

namespace stickslip::daemon {

/// {"name": "liner 42", "grade": …, "direction": …, "side": …, "operator": …, "facts": …, "method": …,
/// "pull_speeds": [0.00508],
///  "replicates": 3, "slides": 1, "limits": {"mu_k": {"lowest": 0.2, "highest": 0.4}}}; all keys are present.
[[nodiscard]] nlohmann::ordered_json batch_plan_json(const BatchPlan& plan);

/// Reads a plan. "name" is required. An absent or null pull_speeds or replicates uses the method's value, if
/// it has one; other absent keys use their defaults. "method" is the name of a shipped method, or the text of
/// a record's process/method. "pull_speeds" and limits with a dimension
/// are text with a unit, "pull_speeds_m_per_s" numbers; a number elsewhere is SI, with a warning. Errors
/// (kUsage) name the key, the value and what is allowed.
[[nodiscard]] base::Result<BatchPlan> batch_plan_of(const nlohmann::ordered_json& json,
                                                    Warnings* warnings = nullptr);

/// {"pull_speed": 0.00508, "replicate": 1, "slide": 1}
[[nodiscard]] nlohmann::ordered_json step_json(const BatchStep& step);
/// {"reason": …, "by": …, "at": …}, or null.
[[nodiscard]] nlohmann::ordered_json voiding_json(const Voiding* voiding);

/// The event as a line of the journal, without line feed.
[[nodiscard]] std::string line_of(const BatchEvent& event);
/// Reads a line of the journal. Errors (kUsage) say what is wrong with it.
[[nodiscard]] base::Result<BatchEvent> event_of(std::string_view line);

}  // namespace stickslip::daemon
