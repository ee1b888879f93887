#include "core/base/regular_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "core/base/wording.hpp"

namespace stickslip::base {
namespace {

/// Of one read(): the kernel never returns more than 2 GiB.
constexpr std::size_t kReadChunk = std::size_t{1} << 24U;

bool was_given_open(const std::filesystem::path& path) {
  const std::string& name = path.native();
  return name == "/dev/stdin" || name.starts_with("/dev/fd/") || name.starts_with("/proc/self/fd/");
}

Result<RegularFile> open(const std::filesystem::path& path, bool any_kind) {
  Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)};
  struct stat found {};
  if (!file.open() || ::fstat(file.get(), &found) != 0) {
    if (errno == ENOENT || errno == ENOTDIR) return usage_error("{}: there is no such file", path.string());
    return failure("{}: cannot be opened: {}", path.string(), system_message(errno));
  }
  if (const std::string why = why_not_regular(found.st_mode);
      !why.empty() && !(any_kind && !S_ISDIR(found.st_mode))) {
    return usage_error("{}: {}", path.string(), why);
  }
  // What is read from a pipe may still be on its way.
  if (any_kind) ::fcntl(file.get(), F_SETFL, 0);
  const auto size = S_ISREG(found.st_mode) ? static_cast<std::uint64_t>(found.st_size) : 0;
  return RegularFile{std::move(file), size};
}

}  // namespace

std::string why_not_regular(mode_t mode) {
  if (S_ISREG(mode)) return {};
  if (S_ISDIR(mode)) return "is a folder, a file is needed";
  if (S_ISFIFO(mode)) return "is a FIFO, not a regular file";
  if (S_ISSOCK(mode)) return "is a socket, not a regular file";
  if (S_ISCHR(mode) || S_ISBLK(mode)) return "is a device, not a regular file";
  return "is not a regular file";
}

Result<RegularFile> open_regular(const std::filesystem::path& path) { return open(path, false); }

Result<RegularFile> open_text(const std::filesystem::path& path) { return open(path, was_given_open(path)); }

Result<std::string> read_text(const std::filesystem::path& path, std::size_t longest) {
  const Result<RegularFile> opened = open_text(path);
  if (!opened) return tl::unexpected(opened.error());
  std::string text;
  std::size_t size = 0;
  while (size < longest) {
    // One byte more than the file says it has, so that the end is seen without another round.
    const std::size_t expected = opened->size + 1;
    const std::size_t chunk = size < expected ? std::min(expected - size, kReadChunk) : kReadChunk;
    text.resize(size + std::min(chunk, longest - size));
    const ssize_t got = ::read(opened->file.get(), text.data() + size, text.size() - size);
    if (got < 0) {
      if (errno == EINTR) continue;
      return failure("{}: cannot be read: {}", path.string(), system_message(errno));
    }
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  text.resize(size);
  return text;
}

}  // namespace stickslip::base
