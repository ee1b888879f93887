/// \file
/// Translates the state of the disk into the state of the storage, with reason and remedy for people.
#pragma once

#include <filesystem>

#include "daemon/storage/disk_writer.hpp"
#include "daemon/types/storage_state.hpp"

namespace stickslip::storage {

/// \param folder  the record folder, for the texts.
[[nodiscard]] daemon::StorageState storage_state(const DiskState& disk, const std::filesystem::path& folder);

}  // namespace stickslip::storage
