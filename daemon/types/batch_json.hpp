/// \file
/// Batches as JSON: what the control interface takes and gives, and the lines of the journal.
#pragma once

#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"
#include "daemon/types/batch.hpp"

namespace stickslip::daemon {

/// {"name": "liner 42", "grade": …, "direction": …, "side": …, "operator": …, "method": …, "pull_speeds":
/// [0.00508],
///  "replicates": 3, "slides": 1, "limits": {"mu_k": {"lowest": 0.2, "highest": 0.4}}}; nothing is left out.
[[nodiscard]] nlohmann::ordered_json batch_plan_json(const BatchPlan& plan);

/// The name must be there; what else is absent or null has its default, that of the method where it says one
/// (its speed, its number of replicates). The method is a name among the shipped ones or a record's text. A
/// speed is m/s or text with a unit. Errors (kUsage) name the key, the value and what is allowed.
[[nodiscard]] base::Result<BatchPlan> batch_plan_of(const nlohmann::ordered_json& json);

/// {"pull_speed": 0.00508, "replicate": 1, "slide": 1}
[[nodiscard]] nlohmann::ordered_json step_json(const BatchStep& step);
/// {"reason": …, "by": …, "at": …}, or null.
[[nodiscard]] nlohmann::ordered_json voiding_json(const Voiding* voiding);

/// One line, without its end.
[[nodiscard]] std::string line_of(const BatchEvent& event);
/// Errors (kUsage) say what is wrong with the line.
[[nodiscard]] base::Result<BatchEvent> event_of(std::string_view line);

}  // namespace stickslip::daemon
