/// \file
/// Sequential reader of a journal's entries, in the memory of the largest entry. Damaged bytes are skipped up
/// to the next complete entry.
///
///     auto entries = JournalEntries::open(path);
///     while (const auto entry = entries->next()) …
///     for (const UnreadBytes& bytes : entries->skipped()) …
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "core/record/file.hpp"
#include "core/record/file_calls.hpp"
#include "core/record/journal_format.hpp"

namespace stickslip::record {

/// Unreadable bytes of a journal, with the reason.
struct UnreadBytes {
  std::uint64_t first = 0;
  std::uint64_t size = 0;
  std::string why;
};

/// Reader of one journal's entries, from front to back. Move-only.
class JournalEntries {
 public:
  /// Errors: kUsage if there is no such file or it is not a regular one, kFailure if it cannot be opened.
  /// \param calls  must outlive the object.
  [[nodiscard]] static base::Result<JournalEntries> open(const std::filesystem::path& path,
                                                         const FileCalls& calls = system_calls());

  /// The next complete entry, valid until the next call of next() or at(). Nullopt at the end and after an
  /// error().
  [[nodiscard]] std::optional<Entry> next();
  /// The complete entry that begins at byte `position`; nullopt if there is none, or after an error(). Valid
  /// as that of next(), which goes on where it was unless there was an error().
  [[nodiscard]] std::optional<Entry> at(std::uint64_t position);

  /// Position of the latest entry from next().
  [[nodiscard]] std::uint64_t position() const noexcept { return position_; }
  /// Damaged bytes skipped so far, rising.
  [[nodiscard]] const std::vector<UnreadBytes>& skipped() const noexcept { return skipped_; }
  /// After next() returned nullopt: the end of the file if it looks as after a stop. The file then ends
  /// within an entry, or contains only zeros: from its beginning, the end of an entry, or a sector boundary
  /// (512 bytes) within one on. Damage can look the same.
  [[nodiscard]] const std::optional<UnreadBytes>& torn_end() const noexcept { return torn_end_; }
  /// Read error of the disk, its place and what helps, without the file's name; empty if there was none. It
  /// stays: only another object reads on. Such bytes do not count as damaged.
  [[nodiscard]] const std::string& error() const noexcept { return error_; }
  /// Bytes when it was opened; what is appended later is not read.
  [[nodiscard]] std::uint64_t file_size() const noexcept { return file_size_; }

 private:
  JournalEntries(Descriptor file, std::uint64_t size, const FileCalls& calls)
      : file_(std::move(file)), calls_(&calls), file_size_(size) {}
  /// Reads `size` bytes from `first` on into bytes_; fewer at the end of the file.
  void read(std::uint64_t first, std::size_t size);
  [[nodiscard]] std::optional<Entry> entry_at(std::uint64_t position, std::string& why);
  /// Position of the next magic number from `first` on.
  [[nodiscard]] std::optional<std::uint64_t> find_magic(std::uint64_t first);
  /// Whether a stop can have left [first, end of file), which contains no complete entry.
  [[nodiscard]] bool is_torn(std::uint64_t first);

  Descriptor file_;
  const FileCalls* calls_;
  std::uint64_t file_size_;
  std::uint64_t position_ = 0;
  std::uint64_t next_ = 0;  ///< Where the next entry should begin.
  std::vector<UnreadBytes> skipped_;
  std::optional<UnreadBytes> torn_end_;
  std::string error_;
  std::vector<std::byte> bytes_;
};

}  // namespace stickslip::record
