/// \file
/// Lock that lets one daemon at a time write to a record folder.
#pragma once

#include <filesystem>
#include <utility>

#include "core/base/result.hpp"
#include "core/record/file.hpp"
#include "core/record/file_calls.hpp"

namespace stickslip::storage {

/// A flock(2) on the folder itself: it needs no file and ends with the process. Readers and `stickslip
/// recover` do not take it. On a file system without locks take() always succeeds (record::probe_folder()
/// tells).
class FolderLock {
 public:
  /// Locks nothing.
  FolderLock() = default;
  /// Takes the lock; does not block. Errors: kFailure if another process holds it, with its process ID if
  /// known.
  [[nodiscard]] static base::Result<FolderLock> take(const std::filesystem::path& folder,
                                                     const record::FileCalls& calls = record::system_calls());

 private:
  explicit FolderLock(record::Descriptor folder) : folder_(std::move(folder)) {}
  record::Descriptor folder_;
};

}  // namespace stickslip::storage
