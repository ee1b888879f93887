#include "core/record/folder_probe.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <system_error>

#include "core/record/file.hpp"
#include "core/record/record.hpp"

namespace stickslip::record {
namespace {

constexpr const char* kPrefix = ".stickslip-probe-";

tl::unexpected<base::Error> refused(const char* what, int error) {
  return base::failure("{}: {}", what, system_message(error));
}

/// That there is no room is said elsewhere, and is no lack of the file system.
bool is_full(int error) { return error == ENOSPC || error == EDQUOT; }

/// Those of a probe that was killed between two calls. One that is at work holds a lock.
void remove_leftovers(const std::filesystem::path& folder, const FileCalls& calls) {
  std::error_code error;
  for (std::filesystem::directory_iterator entry{folder, error}, end; !error && entry != end;
       entry.increment(error)) {
    if (!entry->path().filename().string().starts_with(kPrefix)) continue;
    const Descriptor file{
        calls.open(entry->path().c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0)};
    if (file.open() && (calls.flock(file.get(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK))
      calls.unlink(entry->path().c_str());
  }
}

/// Names of the folder's probe, gone with it.
class ProbeNames {
 public:
  ProbeNames(const std::filesystem::path& folder, const FileCalls& calls)
      : calls_(calls), first_((folder / (kPrefix + make_uuid())).string()), second_(first_ + "-2") {}
  ~ProbeNames() { remove(); }
  ProbeNames(const ProbeNames&) = delete;
  ProbeNames& operator=(const ProbeNames&) = delete;

  void remove() const {
    calls_.unlink(first_.c_str());
    calls_.unlink(second_.c_str());
  }
  [[nodiscard]] const char* first() const { return first_.c_str(); }
  [[nodiscard]] const char* second() const { return second_.c_str(); }

 private:
  const FileCalls& calls_;
  std::string first_;
  std::string second_;
};

}  // namespace

base::Result<std::vector<FolderLack>> probe_folder(const std::filesystem::path& folder,
                                                   const FileCalls& calls) {
  remove_leftovers(folder, calls);
  std::vector<FolderLack> lacks;
  const ProbeNames names{folder, calls};
  constexpr mode_t kMode = 0600;
  const Descriptor file{calls.open(names.first(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kMode)};
  if (!file.open() && is_full(errno)) return lacks;
  if (!file.open()) return refused("cannot be written", errno);
  if (calls.flock(file.get(), LOCK_EX | LOCK_NB) != 0 && errno != EWOULDBLOCK) {
    lacks.push_back({fmt::format("has no locks (flock: {})", system_message(errno)),
                     "stickslip recover and a second daemon cannot see that a journal is being written: run "
                     "neither while this daemon runs"});
  }
  // The names are needed for these two alone.
  const bool renames = calls.rename_to_new(names.first(), names.second()) == 0 || !is_unsupported(errno);
  const bool links = renames || calls.link(names.first(), names.second()) == 0;
  names.remove();
  if (!renames && !links) {
    lacks.push_back({"can rename only by replacing, and has no second names",
                     "a record's name is taken by an empty file first; a power cut in that moment leaves it, "
                     "and the next start replaces it"});
  }
  constexpr std::array<std::byte, 1> kByte{};
  if (write_all(file.get(), kByte, calls) != kByte.size() && !is_full(errno))
    return refused("files in it cannot be written", errno);
  if (calls.fsync(file.get()) != 0 && !is_full(errno)) return refused("files in it cannot be synced", errno);
  const Descriptor opened{calls.open(folder.c_str(), O_RDONLY | O_CLOEXEC, 0)};
  if (!opened.open()) return refused("cannot be opened for reading, which its sync needs", errno);
  if (calls.fsync(opened.get()) != 0 && !is_full(errno)) {
    if (!is_unsupported(errno)) return refused("cannot be synced", errno);
    lacks.push_back({fmt::format("cannot sync folders (fsync: {})", system_message(errno)),
                     "a power cut may take the newest journal or record with it, though its content was "
                     "synced"});
  }
  if (calls.room(folder.c_str()) < 0) {
    lacks.push_back({"does not tell how much room it has",
                     "nobody is warned before it is full; scans then wait in memory, for ten minutes"});
  }
  return lacks;
}

}  // namespace stickslip::record
