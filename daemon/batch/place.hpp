/// \file
/// Reads the place of a record in a batch.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/result.hpp"
#include "daemon/types/batch.hpp"

namespace stickslip::batch {

/// Reads a record in a child process (`program --result FILE`), because errors of HDF5 can end a process;
/// blocks. \param name  of the record in the batch journal. \return nothing if the record belongs to no
/// batch. Errors: kFailure if it cannot be read.
[[nodiscard]] base::Result<std::optional<daemon::TestRecorded>> place_of(const std::string& program,
                                                                         const std::filesystem::path& file,
                                                                         const std::string& name);

}  // namespace stickslip::batch
