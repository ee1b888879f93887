/// \file
/// Locks of journals, and removal of empty ones.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>

#include "core/base/result.hpp"
#include "core/record/file.hpp"

namespace stickslip::record {

/// Exclusive lock on a journal, for writing or finalising it, during the life of the object. The kernel
/// releases it if the process is killed.
class JournalLock {
 public:
  /// \param longest  time to wait for another holder, such as the finaliser of a killed daemon, which ends
  ///        soon.
  /// Errors: kUsage if the file does not exist or is no regular file; kFailure if it cannot be opened, or if
  /// another holder keeps the lock or has removed the file. Succeeds where the file system has no locks.
  [[nodiscard]] static base::Result<JournalLock> take(const std::filesystem::path& journal,
                                                      std::chrono::milliseconds longest = {},
                                                      const FileCalls& calls = system_calls());

 private:
  explicit JournalLock(Descriptor file) : file_(std::move(file)) {}
  Descriptor file_;
};

/// Tries to lock an open journal, without waiting. \return false if another holder has the lock; true also
/// after any other error, as where the file system has no locks.
[[nodiscard]] bool lock_journal(int descriptor, const FileCalls& calls = system_calls()) noexcept;

/// Removes a journal that is empty or consists of a torn end only (JournalEntries::torn_end()). A stop before
/// the header was synced leaves such a file; it contains no data. Other journals, and symbolic
/// links to journals, are not changed.
/// \return whether it was removed. Errors: kFailure if it does not exist, is no regular file, cannot be read
/// or removed, or if another process holds it for longer than `longest`.
[[nodiscard]] base::Result<bool> remove_if_empty(const std::filesystem::path& journal,
                                                 std::chrono::milliseconds longest = {});

}  // namespace stickslip::record
