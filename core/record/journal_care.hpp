/// \file
/// Who may touch a journal, and which of them hold nothing.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>

#include "core/base/result.hpp"
#include "core/record/file.hpp"

namespace stickslip::record {

/// The right to write or to finish a journal, while it lives. The kernel takes it back from who is killed.
class JournalLock {
 public:
  /// \param longest  to wait for somebody who has it: a finaliser whose daemon was killed ends soon.
  /// Errors: kUsage if there is no such file, kFailure if somebody else keeps the right, or has removed the
  /// file. Where the file system has no locks everybody has it.
  [[nodiscard]] static base::Result<JournalLock> take(const std::filesystem::path& journal,
                                                      std::chrono::milliseconds longest = {},
                                                      const FileCalls& calls = system_calls());

 private:
  explicit JournalLock(Descriptor file) : file_(std::move(file)) {}
  Descriptor file_;
};

/// Takes the right for a file that has just been made. \return false if somebody else has it.
[[nodiscard]] bool lock_journal(int descriptor, const FileCalls& calls = system_calls()) noexcept;

/// A journal that is nothing but a torn end (journal_entries.hpp) is what a stop leaves before the header,
/// which comes first, is written and synced: nothing was recorded. All others stay. \return whether it was
/// one and is gone. Errors: kFailure if it cannot be read or removed, or somebody writes it for longer than
/// `longest`.
[[nodiscard]] base::Result<bool> remove_if_empty(const std::filesystem::path& journal,
                                                 std::chrono::milliseconds longest = {});

}  // namespace stickslip::record
