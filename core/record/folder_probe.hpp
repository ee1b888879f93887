/// \file
/// What the file system of a folder lacks that keeps records, and what follows for the people.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "core/record/file_calls.hpp"

namespace stickslip::record {

/// For people: each is the end of a sentence that begins with the folder.
struct FolderLack {
  std::string what;     ///< "cannot sync folders (fsync: Invalid argument)"
  std::string follows;  ///< "a power cut may take the name of the newest record with it"
};

/// Tries in the folder what journals and records need: a new file, write, sync, lock, second name, rename
/// without replacing, sync of the folder, room. The files of it have random names and are gone when it
/// returns; those that a kill left before are removed. \return what is lacking, in spite of which records can
/// be made; none on ext4, XFS, Btrfs. Errors: kFailure if none can be made there, one line without the
/// folder.
[[nodiscard]] base::Result<std::vector<FolderLack>> probe_folder(const std::filesystem::path& folder,
                                                                 const FileCalls& calls = system_calls());

}  // namespace stickslip::record
