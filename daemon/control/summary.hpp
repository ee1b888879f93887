/// \file
/// The latest tests together: mean, repeatability and interval of each result, and how they keep the limits.
#pragma once

#include <functional>
#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "daemon/types/batch.hpp"
#include "daemon/types/test_log.hpp"

namespace stickslip::control {

/// Of the current batch's tests while there is one, else of all. Void tests do not count.
/// \param tests    the latest. \param name_of  of a test's record, in the journal.
[[nodiscard]] nlohmann::ordered_json summary_json(
    std::span<const daemon::TestSummary> tests, const daemon::BatchBook& book,
    const std::function<std::string(const std::string&)>& name_of);

}  // namespace stickslip::control
