/// \file
/// The entries of a journal one after the other, in the memory of the largest of them.
///
///     auto entries = JournalEntries::open(path);
///     while (const auto entry = entries->next()) …
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "core/record/file.hpp"
#include "core/record/journal_format.hpp"

namespace stickslip::record {

/// Move-only.
class JournalEntries {
 public:
  /// Errors: kUsage if there is no such file, kFailure if it cannot be opened.
  [[nodiscard]] static base::Result<JournalEntries> open(const std::filesystem::path& path);

  /// The next whole entry, valid until the next call. Nothing at the end of the file and at the first entry
  /// that is not whole.
  [[nodiscard]] std::optional<Entry> next();

  /// Why the last call gave nothing before the end of the file; empty if it did not.
  [[nodiscard]] const std::string& stopped_by() const noexcept { return stopped_by_; }
  [[nodiscard]] std::uint64_t file_size() const noexcept { return file_size_; }
  /// Bytes of the entries given so far.
  [[nodiscard]] std::uint64_t position() const noexcept { return position_; }

 private:
  JournalEntries(Descriptor file, std::uint64_t size) : file_(std::move(file)), file_size_(size) {}
  /// Fills bytes_ up to `size` from position_ on; less at the end of the file or after an error.
  void fill(std::size_t size);

  Descriptor file_;
  std::uint64_t file_size_;
  std::uint64_t position_ = 0;
  std::string stopped_by_;
  std::vector<std::byte> bytes_;  ///< Of the entry at position_.
};

}  // namespace stickslip::record
