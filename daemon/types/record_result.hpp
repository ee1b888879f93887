/// \file
/// Reads the result of a record in a child process, because errors of HDF5 can end a process.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"
#include "daemon/types/test_log.hpp"

namespace stickslip::daemon {

/// Runs `program --result FILE` and returns the JSON that it prints; blocks. Errors: kFailure, with the file
/// and the stderr of that process.
[[nodiscard]] base::Result<nlohmann::ordered_json> result_of(const std::string& program,
                                                             const std::filesystem::path& file);

/// The summary of a test that an earlier run of the program recorded in `file`; blocks. Errors as
/// result_of().
[[nodiscard]] base::Result<TestSummary> earlier_test(const std::string& program,
                                                     const std::filesystem::path& file);

}  // namespace stickslip::daemon
