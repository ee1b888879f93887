/// \file
/// Reads results that never reached the outbox from the records. So a test can end before its result is in
/// the outbox, and a kill or power cut in between loses no result.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "daemon/fleet/outbox.hpp"

namespace stickslip::fleet {

/// Reads the result of a record in a child process (`program --result FILE`), because errors of HDF5 can end
/// a process; blocks. Nothing if it cannot be read.
[[nodiscard]] std::optional<FleetResult> ask_result(const std::string& program, const std::string& tester,
                                                    const std::filesystem::path& record);

/// Makes a FleetResult of what the child printed. Nothing unless it is a result whose id is a UUID. \param
/// record  its name, without folder and extension.
[[nodiscard]] std::optional<FleetResult> parse_result(const std::string& record, const std::string& tester,
                                                      const std::string& printed);

/// The text that `--result` prints: result_json() of the record. Errors: as record::read_record().
[[nodiscard]] base::Result<std::string> result_of_record(const std::filesystem::path& file);

}  // namespace stickslip::fleet
