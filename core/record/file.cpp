#include "core/record/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

#include "core/base/regular_file.hpp"

namespace stickslip::record {
namespace {

/// As rename(), but `to` was free when it was taken.
int rename_over_own(const char* from, const char* to, const FileCalls& calls) {
  constexpr mode_t kMode = 0644;
  if (!Descriptor{calls.open(to, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode)}.open()) return -1;
  if (calls.rename(from, to) == 0) return 0;
  const int error = errno;
  calls.unlink(to);
  errno = error;
  return -1;
}

int rename_by_link(const char* from, const char* to, const FileCalls& calls) {
  if (calls.link(from, to) == 0) {
    // The file has its new name; if the old one remains, it looks like an unfinished file.
    static_cast<void>(calls.unlink(from));
    return 0;
  }
  // EPERM: as link(2) says it where there are no second names. EMLINK: no more than one.
  if (is_unsupported(errno) || errno == EPERM || errno == EMLINK) return rename_over_own(from, to, calls);
  return -1;
}

}  // namespace

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path{"."};
}

base::Result<void> sync_path(const std::filesystem::path& path, const FileCalls& calls) {
  const Descriptor descriptor{calls.open(path.c_str(), O_RDONLY | O_CLOEXEC, 0)};
  if (!descriptor.open() || calls.fsync(descriptor.get()) != 0) {
    return base::failure("{}: cannot be made durable: {}", path.string(), system_message(errno));
  }
  return {};
}

bool is_unsupported(int error) noexcept {
  // EBADF: some network file systems, of a folder. ENOLCK: where the server has no lock manager.
  return error == EINVAL || error == ENOSYS || error == EOPNOTSUPP || error == ENOTTY || error == EBADF ||
         error == ENOLCK;
}

base::Result<void> sync_folder(const std::filesystem::path& folder, const FileCalls& calls) {
  const Descriptor descriptor{calls.open(folder.c_str(), O_RDONLY | O_CLOEXEC, 0)};
  if (!descriptor.open() || (calls.fsync(descriptor.get()) != 0 && !is_unsupported(errno))) {
    return base::failure("{}: cannot be made durable: {}", folder.string(), system_message(errno));
  }
  return {};
}

base::Result<void> rename_to_new(const std::filesystem::path& from, const std::filesystem::path& to,
                                 const FileCalls& calls) {
  int status = calls.rename_to_new(from.c_str(), to.c_str());
  if (status != 0 && is_unsupported(errno)) status = rename_by_link(from.c_str(), to.c_str(), calls);
  if (status != 0 && errno == EEXIST) {
    return base::usage_error("{}: exists already and is never overwritten: choose another name", to.string());
  }
  if (status != 0) {
    return base::failure("{}: cannot be renamed to {}: {}", from.string(), to.string(),
                         system_message(errno));
  }
  return sync_folder(folder_of(to), calls);
}

base::Result<void> make_folders(const std::filesystem::path& folder, const FileCalls& calls) {
  std::error_code ignored;
  if (folder.empty() || std::filesystem::is_directory(folder, ignored)) return {};
  if (auto made = make_folders(folder.parent_path(), calls); !made) return made;
  constexpr mode_t kMode = 0755;
  if (calls.mkdir(folder.c_str(), kMode) != 0) {
    if (errno != EEXIST)
      return base::failure("{}: cannot be made: {}", folder.string(), system_message(errno));
    // Another program may have made it meanwhile.
    if (!std::filesystem::is_directory(folder, ignored))
      return base::failure("{}: is no folder: move it away", folder.string());
  }
  return sync_folder(folder_of(folder), calls);
}

std::size_t write_all(int descriptor, std::span<const std::byte> bytes, const FileCalls& calls) {
  std::size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t status = calls.write(descriptor, bytes.data() + written, bytes.size() - written);
    if (status < 0 && errno == EINTR) continue;
    if (status == 0) errno = EIO;
    if (status <= 0) break;
    written += static_cast<std::size_t>(status);
  }
  return written;
}

base::Result<std::vector<std::byte>> read_file(const std::filesystem::path& path) {
  const base::Result<std::string> text = base::read_text(path);
  if (!text) return tl::unexpected(text.error());
  const auto bytes = std::as_bytes(std::span{*text});
  return std::vector<std::byte>{bytes.begin(), bytes.end()};
}

}  // namespace stickslip::record
