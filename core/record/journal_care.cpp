#include "core/record/journal_care.hpp"

#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <thread>

#include "core/base/regular_file.hpp"
#include "core/record/journal_entries.hpp"

namespace stickslip::record {

bool lock_journal(int descriptor, const FileCalls& calls) noexcept {
  return calls.flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
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
  if (!S_ISREG(found.st_mode)) return false;
  auto entries = JournalEntries::open(journal);
  if (!entries) return tl::unexpected(base::Error{base::ErrorKind::kFailure, entries.error().message});
  if (entries->next()) return false;
  if (!entries->error().empty()) return base::failure("{}: {}", journal.string(), entries->error());
  if (!entries->skipped().empty()) return false;
  if (::unlink(journal.c_str()) != 0)
    return base::failure("{}: cannot be removed: {}", journal.string(), system_message(errno));
  return true;
}

}  // namespace stickslip::record
