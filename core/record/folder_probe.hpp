/// \file
/// Probe of a records folder: file system features that are missing, and their consequences.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "core/record/file_calls.hpp"

namespace stickslip::record {

/// A missing feature of the file system. Both texts are for "the file system WHAT: FOLLOWS".
struct FolderLack {
  std::string what;     ///< "cannot sync folders (fsync: Invalid argument)"
  std::string follows;  ///< Consequence: "a power cut may take the newest journal or record with it"
};

/// Tries the operations that journals and records need: create, write, sync, lock, rename without replacing
/// (or else hard link), sync of the folder, free space. Its files have random names and are removed, as are
/// those left by a killed probe.
/// \return missing features without which records can still be made; none on ext4, XFS, Btrfs. A creation,
/// write or sync that fails because the disk is full counts as working. Errors: kFailure if no record can be
/// made; one line without the folder.
[[nodiscard]] base::Result<std::vector<FolderLack>> probe_folder(const std::filesystem::path& folder,
                                                                 const FileCalls& calls = system_calls());

}  // namespace stickslip::record
