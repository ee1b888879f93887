#include "core/record/journal_entries.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "core/base/regular_file.hpp"

namespace stickslip::record {

base::Result<JournalEntries> JournalEntries::open(const std::filesystem::path& path) {
  base::Result<base::RegularFile> opened = base::open_regular(path);
  if (!opened) return tl::unexpected(opened.error());
  return JournalEntries{std::move(opened->file), opened->size};
}

void JournalEntries::fill(std::size_t size) {
  std::size_t filled = bytes_.size();
  bytes_.resize(size);
  while (filled < size) {
    const ssize_t got =
        ::pread(file_.get(), bytes_.data() + filled, size - filled, static_cast<off_t>(position_ + filled));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) stopped_by_ = "cannot be read: " + system_message(errno);
    if (got <= 0) break;
    filled += static_cast<std::size_t>(got);
  }
  bytes_.resize(filled);
}

std::optional<Entry> JournalEntries::next() {
  if (position_ == file_size_ || !stopped_by_.empty()) return std::nullopt;
  bytes_.clear();
  fill(kEntryHeadSize);
  EntryHead head;
  if (bytes_.size() == kEntryHeadSize) {
    std::memcpy(&head, bytes_.data(), kEntryHeadSize);
    // A head that is none may claim any size: no more than the file has.
    const std::uint64_t left = file_size_ - position_ - kEntryHeadSize;
    if (head.magic == EntryHead{}.magic && head.payload_size <= left)
      fill(kEntryHeadSize + head.payload_size);
  }
  if (!stopped_by_.empty()) return std::nullopt;
  std::optional<Entry> entry = first_entry(bytes_, stopped_by_);
  if (entry) position_ += kEntryHeadSize + entry->payload.size();
  return entry;
}

}  // namespace stickslip::record
