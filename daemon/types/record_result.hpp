/// \file
/// What a record says of its test, read by a process of its own: HDF5's errors can end a process.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"
#include "daemon/types/test_log.hpp"

namespace stickslip::daemon {

/// What `program --result FILE` prints. Errors: kFailure naming the file, with what that process said.
[[nodiscard]] base::Result<nlohmann::ordered_json> result_of(const std::string& program,
                                                             const std::filesystem::path& file);

/// A test of before the program began, with its record as its file. Errors as result_of().
[[nodiscard]] base::Result<TestSummary> earlier_test(const std::string& program,
                                                     const std::filesystem::path& file);

}  // namespace stickslip::daemon
