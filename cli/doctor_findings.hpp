/// \file
/// The findings of the doctor as text and as JSON.
#pragma once

#include <string>
#include <vector>

#include "cli/doctor/finding.hpp"
#include <nlohmann/json_fwd.hpp>

namespace stickslip::cli {

/// One line for each finding, and its remedy below it.
[[nodiscard]] std::string findings_text(const std::vector<doctor::Finding>& findings, bool colours);

/// {"exit_status": …, "findings": [{"check": …, "verdict": …, "what": …, "to_do": …}]}
[[nodiscard]] nlohmann::ordered_json findings_json(const std::vector<doctor::Finding>& findings);

}  // namespace stickslip::cli
