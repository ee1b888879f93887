/// \file
/// Results that a former program had no time to put into its outbox: they stand in the records. So an outbox
/// need not be written before a test may end, and neither a kill nor a power cut between the two loses one.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "daemon/fleet/outbox.hpp"

namespace stickslip::fleet {

/// The result of a record, read by a process of its own (`stickslipd --result FILE`): HDF5's errors can end a
/// process. Nothing if it cannot be read.
[[nodiscard]] std::optional<FleetResult> ask_result(const std::string& program, const std::string& tester,
                                                    const std::filesystem::path& record);

/// \param printed  by that process. Nothing unless it is a result whose id is a UUID.
[[nodiscard]] std::optional<FleetResult> parse_result(const std::string& record, const std::string& tester,
                                                      const std::string& printed);

/// What that process prints: result_json(). Errors as record::read_record().
[[nodiscard]] base::Result<std::string> result_of_record(const std::filesystem::path& file);

}  // namespace stickslip::fleet
