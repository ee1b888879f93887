/// \file
/// The file of a journal; each write adds complete entries or nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "core/base/result.hpp"
#include "core/record/file.hpp"
#include "core/record/file_calls.hpp"

namespace stickslip::record {

/// A journal's file, open for writing. Not thread-safe. Move-only. Destruction closes without syncing.
class JournalFile {
 public:
  /// Creates the file, which must not exist, locks it (journal_care.hpp), writes its first entry, and syncs
  /// content and name. Errors: kFailure; its file is then removed if possible, unless another process has
  /// locked it.
  /// \param header  bytes of the first entry.
  /// \param calls  must outlive the object.
  [[nodiscard]] static base::Result<JournalFile> create(const std::filesystem::path& path,
                                                        std::span<const std::byte> header,
                                                        const FileCalls& calls);

  /// Relation of the file's path to the open file.
  enum class Place {
    kItself,
    kNothing,  ///< Removed, renamed, or its folder was.
    kAnother,  ///< Another file has the path.
    kUnknown,  ///< The path or the open file cannot be examined; see errno.
  };
  [[nodiscard]] Place place() const;

  /// Creates a file at `path`, as create(), with all entries of this one. They are read from the open file,
  /// which may have lost its name. This file is unchanged.
  [[nodiscard]] base::Result<JournalFile> copy_to(const std::filesystem::path& path) const;

  /// Releases the lock, so that another process may finalise the journal.
  void unlock();

  /// Adds complete entries. On an error none is added: the file is truncated to its old size, now or before
  /// the next attempt, and the call may be repeated. Errors: kFailure.
  [[nodiscard]] base::Result<void> append(std::span<const std::byte> entries);

  /// fdatasync: everything appended so far survives a power cut if this succeeds. If it fails, the data
  /// appended since the last success may be lost even if a later call succeeds: the kernel may have dropped
  /// them [fsync(2); Rebello et al. 2020, "Can applications recover from fsync failures?"]. Remove them by
  /// cut_to() and append them again.
  [[nodiscard]] base::Result<void> sync();

  /// Truncates the file to `size` bytes, the end of an entry, now or before the next append.
  void cut_to(std::uint64_t size);
  /// Releases the disk space reserved beyond the end, now or before the next append.
  void give_room_back();

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  /// Bytes of complete entries.
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

 private:
  JournalFile(std::filesystem::path path, Descriptor file, const FileCalls& calls)
      : path_(std::move(path)), file_(std::move(file)), calls_(&calls) {}
  /// Creates a file, fills and syncs it; removes it on an error.
  [[nodiscard]] static base::Result<JournalFile> make(
      const std::filesystem::path& path, const FileCalls& calls,
      const std::function<base::Result<void>(JournalFile&)>& fill);
  [[nodiscard]] base::Result<void> cut();
  void reserve(std::uint64_t size);

  std::filesystem::path path_;
  Descriptor file_;
  const FileCalls* calls_;
  std::uint64_t size_ = 0;
  std::uint64_t reserved_ = 0;  ///< Bytes from the beginning on with reserved disk space.
  bool has_rest_ = false;       ///< Bytes may exist beyond size_.
};

}  // namespace stickslip::record
