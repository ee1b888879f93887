/// \file
/// What the state of the disk means for those who measure.
#pragma once

#include <filesystem>

#include "daemon/storage/disk_writer.hpp"
#include "daemon/types/storage_state.hpp"

namespace stickslip::storage {

/// Whether there is room for records, why not, and what to do. \param folder  of the records.
[[nodiscard]] daemon::StorageState storage_state(const DiskState& disk, const std::filesystem::path& folder);

}  // namespace stickslip::storage
