/// \file
/// Reads finished records back, whole: everything that is needed to run the test again.
#pragma once

#include <filesystem>

#include "core/base/result.hpp"
#include "core/record/record.hpp"

namespace stickslip::record {

/// \return the record with `end` and `sha256` set. Errors are one line that names the file and what
/// is wrong: kUsage if it is no HDF5 file, no record, another version, cut short, damaged or has
/// data of other types or shapes; kFailure if it cannot be read.
[[nodiscard]] base::Result<Record> read_record(const std::filesystem::path& path);

}  // namespace stickslip::record
