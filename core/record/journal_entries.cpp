#include "core/record/journal_entries.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include "core/base/regular_file.hpp"

namespace stickslip::record {
namespace {

constexpr std::array<char, 4> kMagic = EntryHead{}.magic;
constexpr std::uint64_t kSector = 512;
constexpr std::size_t kWindow = std::size_t{1} << 16U;

/// What the disk does not give now is not damaged: it may give it later, and a copy can do without.
std::string why_not_read(int error, std::uint64_t position) {
  std::string why = fmt::format("cannot be read at byte {}: {}", position, system_message(error));
  if (error == EIO) {
    why +=
        "; try again, and if the disk stays bad copy the file to another one (ddrescue puts zeros where it "
        "cannot "
        "read), and let stickslip recover take the copy";
  }
  return why;
}

}  // namespace

base::Result<JournalEntries> JournalEntries::open(const std::filesystem::path& path, const FileCalls& calls) {
  base::Result<base::RegularFile> opened = base::open_regular(path);
  if (!opened) return tl::unexpected(opened.error());
  return JournalEntries{std::move(opened->file), opened->size, calls};
}

void JournalEntries::read(std::uint64_t first, std::size_t size) {
  bytes_.resize(
      static_cast<std::size_t>(std::min<std::uint64_t>(size, file_size_ - std::min(first, file_size_))));
  std::size_t filled = 0;
  while (filled < bytes_.size()) {
    const std::uint64_t from = first + filled;
    const ssize_t got =
        calls_->pread(file_.get(), bytes_.data() + filled, bytes_.size() - filled, static_cast<off_t>(from));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) error_ = why_not_read(errno, from);
    if (got <= 0) break;
    filled += static_cast<std::size_t>(got);
  }
  bytes_.resize(filled);
}

std::optional<Entry> JournalEntries::entry_at(std::uint64_t position, std::string& why) {
  read(position, kEntryHeadSize);
  EntryHead head;
  if (bytes_.size() == kEntryHeadSize) {
    std::memcpy(&head, bytes_.data(), kEntryHeadSize);
    // A head that is none may claim any size: no more than the file has.
    const std::uint64_t left = file_size_ - position - kEntryHeadSize;
    if (head.magic == kMagic && head.payload_size <= left) read(position, kEntryHeadSize + head.payload_size);
  }
  if (!error_.empty()) return std::nullopt;
  std::optional<Entry> entry = first_entry(bytes_, why);
  return entry;
}

std::optional<Entry> JournalEntries::at(std::uint64_t position) {
  std::string why;
  return entry_at(position, why);
}

std::optional<std::uint64_t> JournalEntries::find_magic(std::uint64_t first) {
  const std::string_view magic{kMagic.data(), kMagic.size()};
  // Windows overlap by what a magic may hang over.
  for (; first < file_size_; first += kWindow - (kMagic.size() - 1)) {
    read(first, kWindow);
    if (!error_.empty()) return std::nullopt;
    const std::string_view text{reinterpret_cast<const char*>(bytes_.data()), bytes_.size()};
    if (const std::size_t found = text.find(magic); found != std::string_view::npos) return first + found;
  }
  return std::nullopt;
}

bool JournalEntries::is_torn(std::uint64_t first) {
  std::uint64_t content_end = first;
  for (std::uint64_t from = first; from < file_size_; from += kWindow) {
    read(from, kWindow);
    const auto last =
        std::find_if(bytes_.rbegin(), bytes_.rend(), [](std::byte byte) { return byte != std::byte{0}; });
    if (last != bytes_.rend()) content_end = from + static_cast<std::uint64_t>(bytes_.rend() - last);
  }
  if (content_end == first) return true;
  // Zeros are what the disk did not get only if they begin with a sector.
  const std::uint64_t border = (content_end + kSector - 1) / kSector * kSector;
  read(first, kEntryHeadSize);
  const std::uint64_t size = std::min(border, file_size_) - first;
  const auto head_size = static_cast<std::size_t>(std::min<std::uint64_t>(bytes_.size(), size));
  EntryHead head;
  std::memcpy(&head, bytes_.data(), head_size);
  if (std::memcmp(head.magic.data(), kMagic.data(), kMagic.size()) != 0) return false;
  return head_size < kEntryHeadSize || head.payload_size > size - kEntryHeadSize;
}

std::optional<Entry> JournalEntries::next() {
  if (next_ == file_size_ || !error_.empty()) return std::nullopt;
  std::string why;
  std::string ignored;
  std::uint64_t place = next_;
  std::optional<Entry> entry = entry_at(place, why);
  while (!entry && error_.empty()) {
    const std::optional<std::uint64_t> found = find_magic(place + 1);
    if (!found) break;
    place = *found;
    entry = entry_at(place, ignored);
  }
  if (!error_.empty()) return std::nullopt;
  if (!entry) {
    UnreadBytes rest{next_, file_size_ - next_, std::move(why)};
    if (is_torn(next_)) {
      torn_end_ = std::move(rest);
    } else {
      skipped_.push_back(std::move(rest));
    }
    next_ = file_size_;
    return std::nullopt;
  }
  if (place > next_) skipped_.push_back({next_, place - next_, std::move(why)});
  position_ = place;
  next_ = place + kEntryHeadSize + entry->payload.size();
  return entry;
}

}  // namespace stickslip::record
