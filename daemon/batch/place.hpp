/// \file
/// What a record says of its place in a batch.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/result.hpp"
#include "daemon/types/batch.hpp"

namespace stickslip::batch {

/// Read by a process of its own (`program --result FILE`): HDF5's errors can end a process.
/// \param name  of the record in the journal. \return nothing if it is of no batch. Errors: kFailure if it
/// cannot be read.
[[nodiscard]] base::Result<std::optional<daemon::TestRecorded>> place_of(const std::string& program,
                                                                         const std::filesystem::path& file,
                                                                         const std::string& name);

}  // namespace stickslip::batch
