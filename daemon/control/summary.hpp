/// \file
/// Summary of the latest tests: mean, repeatability and interval of each result, and the check of the batch's
/// limits.
#pragma once

#include <functional>
#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "daemon/types/batch.hpp"
#include "daemon/types/test_log.hpp"

namespace stickslip::control {

/// Summarises the current batch's tests if there is a batch, else all. Void tests do not count.
/// \param tests    the latest ones. \param name_of  gives the name of a record in the batch journal.
[[nodiscard]] nlohmann::ordered_json summary_json(
    std::span<const daemon::TestSummary> tests, const daemon::BatchBook& book,
    const std::function<std::string(const std::string&)>& name_of);

}  // namespace stickslip::control
