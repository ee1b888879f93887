#include "core/record/given_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>
#include <vector>

#include "core/base/regular_file.hpp"

namespace stickslip::record {
namespace {

/// A smaller file is kept: HDF5 reads that of a short test in some 400 places.
constexpr std::size_t kReadAtOnce = std::size_t{1} << 20U;

base::ErrorKind kind_of(int error) noexcept {
  switch (error) {
    case ENOENT:
    case ENOTDIR:
    case ENAMETOOLONG:
    case ELOOP:
      return base::ErrorKind::kUsage;
    case EACCES:
    case EPERM:
      return base::ErrorKind::kNoPermission;
    case EAGAIN:
    case EBUSY:
    case ETXTBSY:
      return base::ErrorKind::kBusy;
    default:
      return base::ErrorKind::kFailure;
  }
}

tl::unexpected<base::Error> cannot_look(int error) {
  return tl::unexpected(base::Error{kind_of(error), why_unreadable(error)});
}

}  // namespace

std::string why_unreadable(int error) {
  switch (error) {
    case ENOENT:
    case ENOTDIR:
      return "there is no such file";
    case EACCES:
    case EPERM:
      return fmt::format("cannot be opened: {}: have its owner say chmod a+r, or read it as its owner",
                         system_message(error));
    case EAGAIN:  // EWOULDBLOCK: of flock().
    case EBUSY:
    case ETXTBSY:
      return "is open for writing in another program: close it there (h5py has it open in mode r+), then try "
             "again";
    case EMFILE:
    case ENFILE:
      return fmt::format("cannot be opened: {}: end other programs or raise ulimit -n, then try again",
                         system_message(error));
    case ENOMEM:
      return "cannot be read now: there is no memory left: end other programs, then try again";
    case EIO:
    case ESTALE:
    case ENOTCONN:
    case EHOSTDOWN:
    case EHOSTUNREACH:
    case ETIMEDOUT:
    case ENXIO:
    case ENODEV:
      return fmt::format(
          "cannot be read now: {}: this says nothing of its content; see to its disk or network (dmesg), "
          "then try again",
          system_message(error));
    default:
      return fmt::format("cannot be opened: {}", system_message(error));
  }
}

base::Result<GivenFile> GivenFile::open(const std::filesystem::path& path, const FileCalls& calls) {
  // Not to wait for the other end of a pipe.
  Descriptor file{calls.open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK, 0)};
  struct stat found {};
  if (!file.open() || ::fstat(file.get(), &found) != 0) return cannot_look(errno);
  if (const std::string why = base::why_not_regular(found.st_mode); !why.empty())
    return base::usage_error("{}", why);
  auto state = std::make_shared<State>();
  state->file = std::move(file);
  state->size = static_cast<std::uint64_t>(found.st_size);
  state->calls = &calls;
  return GivenFile{std::move(state)};
}

base::Result<void> GivenFile::share() const {
  int status = 0;
  do {
    status = state_->calls->flock(state_->file.get(), LOCK_SH | LOCK_NB);
  } while (status != 0 && errno == EINTR);
  if (status == 0 || is_unsupported(errno)) return {};
  return cannot_look(errno);
}

ssize_t GivenFile::read(std::span<std::byte> bytes, std::uint64_t position) const {
  if (const std::vector<std::byte>& kept = state_->kept; !kept.empty()) {
    const auto left = std::span{kept}.subspan(std::min<std::uint64_t>(position, kept.size()));
    const std::size_t count = std::min(bytes.size(), left.size());
    std::copy_n(left.begin(), count, bytes.begin());
    return static_cast<ssize_t>(count);
  }
  for (;;) {
    const ssize_t got =
        state_->calls->pread(state_->file.get(), bytes.data(), bytes.size(), static_cast<off_t>(position));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) state_->refused = errno;
    return got;
  }
}

bool GivenFile::load() const {
  std::vector<std::byte> block(std::clamp<std::uint64_t>(size(), 1, kReadAtOnce));
  ssize_t got = 0;
  for (std::uint64_t at = 0; (got = read(block, at)) > 0; at += static_cast<std::uint64_t>(got)) {
    if (at == 0 && static_cast<std::uint64_t>(got) == size()) {
      state_->kept = std::move(block);
      return true;
    }
  }
  return got == 0;
}

base::Result<GivenFile> open_shared(const std::filesystem::path& path, const FileCalls& calls) {
  auto file = GivenFile::open(path, calls);
  if (!file) return file;
  if (auto locked = file->share(); !locked) return tl::unexpected(locked.error());
  if (!file->load()) return cannot_look(file->refused());
  return file;
}

}  // namespace stickslip::record
