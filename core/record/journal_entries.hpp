/// \file
/// The entries of a journal one after the other, in the memory of the largest of them. What is no whole entry
/// is skipped: reading goes on at the next one, wherever it stands.
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

/// Bytes of a journal that gave nothing.
struct UnreadBytes {
  std::uint64_t first = 0;
  std::uint64_t size = 0;
  std::string why;
};

/// Move-only.
class JournalEntries {
 public:
  /// Errors: kUsage if there is no such file, kFailure if it cannot be opened.
  /// \param calls  outlive it.
  [[nodiscard]] static base::Result<JournalEntries> open(const std::filesystem::path& path,
                                                         const FileCalls& calls = system_calls());

  /// The next whole entry, valid until the next call of any kind. Nothing when none follows, and after an
  /// error().
  [[nodiscard]] std::optional<Entry> next();
  /// The whole entry that begins at the byte `position`, valid as above; next() goes on as if nobody had
  /// asked.
  [[nodiscard]] std::optional<Entry> at(std::uint64_t position);

  /// Byte at which the last entry of next() begins.
  [[nodiscard]] std::uint64_t position() const noexcept { return position_; }
  /// What was skipped so far because it is damaged, rising.
  [[nodiscard]] const std::vector<UnreadBytes>& skipped() const noexcept { return skipped_; }
  /// Once next() gave nothing: the end of the file, if it is as a stop leaves it. Either the file ends within
  /// an entry, or it has zeros from the border of a sector within an entry on. Damage can look the same.
  [[nodiscard]] const std::optional<UnreadBytes>& torn_end() const noexcept { return torn_end_; }
  /// Why the file cannot be read on, and what to do; empty if it can. What the disk does not give is not
  /// damaged.
  [[nodiscard]] const std::string& error() const noexcept { return error_; }
  [[nodiscard]] std::uint64_t file_size() const noexcept { return file_size_; }

 private:
  JournalEntries(Descriptor file, std::uint64_t size, const FileCalls& calls)
      : file_(std::move(file)), calls_(&calls), file_size_(size) {}
  /// Lets bytes_ hold those from `first` on, `size` of them or fewer at the end of the file.
  void read(std::uint64_t first, std::size_t size);
  [[nodiscard]] std::optional<Entry> entry_at(std::uint64_t position, std::string& why);
  /// Where the next magic stands, from `first` on.
  [[nodiscard]] std::optional<std::uint64_t> find_magic(std::uint64_t first);
  /// Whether a stop can have left [first, end of file) so; no whole entry stands in it.
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
