/// \file
/// The file of a journal: whole entries or nothing.
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

/// Not thread-safe. Move-only. Destruction closes without syncing.
class JournalFile {
 public:
  /// Makes the file, which must not exist, locks it (journal_care.hpp), writes its first entry and makes
  /// content and name durable. Errors (kFailure) leave no file behind. \param calls  outlive the file.
  [[nodiscard]] static base::Result<JournalFile> create(const std::filesystem::path& path,
                                                        std::span<const std::byte> header,
                                                        const FileCalls& calls);

  /// What stands at the path of the file.
  enum class Place {
    kItself,
    kNothing,  ///< Removed, renamed, or its folder was.
    kAnother,  ///< Another file.
    kUnknown,  ///< It cannot be looked at: errno says why.
  };
  [[nodiscard]] Place place() const;

  /// Makes another file with the same entries, read from what is open: what stands at the path does not
  /// matter. As create() otherwise. Errors: kFailure; this file stays what it is.
  [[nodiscard]] base::Result<JournalFile> copy_to(const std::filesystem::path& path) const;

  /// Gives the lock back: others may finish the journal.
  void unlock();

  /// Adds whole entries, or none: then the file is cut back to what it was, now or before the next attempt,
  /// and the same may be tried again.
  [[nodiscard]] base::Result<void> append(std::span<const std::byte> entries);

  /// fdatasync: everything appended so far survives a power cut if this succeeds. If not, nothing is known of
  /// what was appended since the last success: the kernel may have dropped it [fsync(2); Rebello et al. 2020,
  /// "Can applications recover from fsync failures?"].
  [[nodiscard]] base::Result<void> sync();

  /// Forgets what was appended behind `size`, now or before the next attempt to append.
  void cut_to(std::uint64_t size);
  /// What was reserved behind the end; before the next attempt to append at the latest.
  void give_room_back();

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  /// Bytes in whole entries.
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

 private:
  JournalFile(std::filesystem::path path, Descriptor file, const FileCalls& calls)
      : path_(std::move(path)), file_(std::move(file)), calls_(&calls) {}
  /// A new file, filled, durable; or none.
  [[nodiscard]] static base::Result<JournalFile> make(
      const std::filesystem::path& path, const FileCalls& calls,
      const std::function<base::Result<void>(JournalFile&)>& fill);
  [[nodiscard]] base::Result<void> cut();
  void reserve(std::uint64_t size);

  std::filesystem::path path_;
  Descriptor file_;
  const FileCalls* calls_;
  std::uint64_t size_ = 0;
  std::uint64_t reserved_ = 0;  ///< Bytes from the beginning on for which there is room on the disk.
  bool has_rest_ = false;       ///< Something may stand behind size_.
};

}  // namespace stickslip::record
