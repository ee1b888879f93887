/// \file
/// One daemon at a time writes to a record folder.
#pragma once

#include <filesystem>
#include <utility>

#include "core/base/result.hpp"
#include "core/record/file.hpp"
#include "core/record/file_calls.hpp"

namespace stickslip::storage {

/// A lock of the folder itself (flock), which leaves no file behind and ends with the process. Programs that
/// only read, and `stickslip recover`, do not ask for it. Where the file system has no locks everybody has it
/// (record::probe_folder() tells).
class FolderLock {
 public:
  /// Locks nothing.
  FolderLock() = default;
  /// Errors: kFailure if another process has it; its number is told where the system knows it.
  [[nodiscard]] static base::Result<FolderLock> take(const std::filesystem::path& folder,
                                                     const record::FileCalls& calls = record::system_calls());

 private:
  explicit FolderLock(record::Descriptor folder) : folder_(std::move(folder)) {}
  record::Descriptor folder_;
};

}  // namespace stickslip::storage
