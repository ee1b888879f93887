#include "core/record/journal_care.hpp"

#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/regular_file.hpp"
#include "core/record/journal_format.hpp"

namespace stickslip::record {
namespace {

/// More than any stop leaves unreadable at the end of a journal, and more than any header.
constexpr std::size_t kLongestTail = std::size_t{1} << 26U;

/// At most so much of the file from `position` on.
std::vector<std::byte> tail_of(const std::filesystem::path& path, std::uint64_t position) {
  const auto opened = base::open_regular(path);
  if (!opened) return {};
  const Descriptor& file = opened->file;
  const std::uint64_t end = opened->size;
  std::vector<std::byte> bytes(std::min<std::uint64_t>(end - std::min(end, position), kLongestTail));
  std::size_t size = 0;
  while (size < bytes.size()) {
    const ssize_t got =
        ::pread(file.get(), bytes.data() + size, bytes.size() - size, static_cast<off_t>(position + size));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    size += static_cast<std::size_t>(got);
  }
  bytes.resize(size);
  return bytes;
}

bool has_entry(std::span<const std::byte> bytes, std::size_t from) {
  const std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  const EntryHead any;
  const std::string_view magic{any.magic.data(), any.magic.size()};
  for (std::size_t at = text.find(magic, from); at != std::string_view::npos; at = text.find(magic, at + 1)) {
    std::string why;
    if (first_entry(bytes.subspan(at), why)) return true;
  }
  return false;
}

/// Whether the file begins as a journal, or as room that a power cut left without content.
bool begins_as_own(std::span<const std::byte> bytes) {
  const EntryHead own;
  constexpr std::array<char, 4> kNothing{};
  const std::size_t size = std::min(bytes.size(), own.magic.size());
  return std::memcmp(bytes.data(), own.magic.data(), size) == 0 ||
         std::memcmp(bytes.data(), kNothing.data(), size) == 0;
}

}  // namespace

bool lock_journal(int descriptor, const FileCalls& calls) noexcept {
  return calls.flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

bool has_entry_behind(const std::filesystem::path& journal, std::uint64_t position) {
  return has_entry(tail_of(journal, position), 1);
}

base::Result<JournalLock> JournalLock::take(const std::filesystem::path& journal,
                                            std::chrono::milliseconds longest, const FileCalls& calls) {
  // NFS locks for oneself alone only what may be written.
  constexpr int kFlags = O_CLOEXEC | O_NONBLOCK;
  Descriptor file{calls.open(journal.c_str(), O_RDWR | kFlags, 0)};
  if (!file.open()) file = Descriptor{calls.open(journal.c_str(), O_RDONLY | kFlags, 0)};
  if (!file.open()) {
    if (errno == ENOENT || errno == ENOTDIR)
      return base::usage_error("{}: there is no such file", journal.string());
    return base::failure("{}: cannot be opened: {}", journal.string(), system_message(errno));
  }
  struct stat found {};
  if (::fstat(file.get(), &found) == 0 && !S_ISREG(found.st_mode))
    return base::usage_error("{}: {}", journal.string(), base::why_not_regular(found.st_mode));
  // Waiting inside flock() could not be given up.
  constexpr std::chrono::milliseconds kPause{20};
  while (!lock_journal(file.get(), calls) && longest.count() > 0) {
    std::this_thread::sleep_for(kPause);
    longest -= kPause;
  }
  if (!lock_journal(file.get(), calls))
    return base::failure("{}: is being written or finished by another process", journal.string());
  if (::fstat(file.get(), &found) != 0 || found.st_nlink == 0)
    return base::failure("{}: has just been finished by another process", journal.string());
  return JournalLock{std::move(file)};
}

base::Result<bool> remove_if_empty(const std::filesystem::path& journal, std::chrono::milliseconds longest) {
  const auto lock = JournalLock::take(journal, longest);
  if (!lock) return tl::unexpected(base::Error{base::ErrorKind::kFailure, lock.error().message});
  struct stat found {};
  if (::lstat(journal.c_str(), &found) != 0)
    return base::failure("{}: cannot be read: {}", journal.string(), system_message(errno));
  if (!S_ISREG(found.st_mode) || found.st_size >= static_cast<off_t>(kLongestTail)) return false;
  const std::vector<std::byte> bytes = tail_of(journal, 0);
  if (bytes.size() != static_cast<std::size_t>(found.st_size))
    return base::failure("{}: cannot be read whole", journal.string());
  if (!bytes.empty() && (!begins_as_own(bytes) || has_entry(bytes, 0))) return false;
  if (::unlink(journal.c_str()) != 0)
    return base::failure("{}: cannot be removed: {}", journal.string(), system_message(errno));
  return true;
}

}  // namespace stickslip::record
