#include "core/record/journal_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <vector>

#include "core/record/journal_care.hpp"

namespace stickslip::record {
namespace {

constexpr mode_t kFileMode = 0644;
/// Disk space reserved ahead: 20 minutes at 350 scans/s. Measured: all of it can be used on a full disk.
constexpr std::uint64_t kReserve = std::uint64_t{1} << 20U;
constexpr std::uint64_t kCopyPiece = std::uint64_t{1} << 20U;

}  // namespace

base::Result<JournalFile> JournalFile::make(const std::filesystem::path& path, const FileCalls& calls,
                                            const std::function<base::Result<void>(JournalFile&)>& fill) {
  Descriptor opened{calls.open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, kFileMode)};
  if (!opened.open()) return base::failure("{}: cannot be created: {}", path.string(), system_message(errno));
  if (!lock_journal(opened.get(), calls)) return base::failure("{}: is another process's", path.string());
  JournalFile file{path, std::move(opened), calls};
  auto written = fill(file);
  if (written && calls.fsync(file.file_.get()) != 0)
    written = base::failure("{}: cannot be made durable: {}", path.string(), system_message(errno));
  if (written) written = sync_folder(folder_of(path), calls);
  if (!written) {
    calls.unlink(path.c_str());
    return tl::unexpected(written.error());
  }
  return file;
}

base::Result<JournalFile> JournalFile::create(const std::filesystem::path& path,
                                              std::span<const std::byte> header, const FileCalls& calls) {
  return make(path, calls, [header](JournalFile& file) { return file.append(header); });
}

base::Result<JournalFile> JournalFile::copy_to(const std::filesystem::path& path) const {
  return make(path, *calls_, [this](JournalFile& copy) -> base::Result<void> {
    std::vector<std::byte> piece;
    while (copy.size_ < size_) {
      piece.resize(std::min<std::uint64_t>(kCopyPiece, size_ - copy.size_));
      const ssize_t got =
          calls_->pread(file_.get(), piece.data(), piece.size(), static_cast<off_t>(copy.size_));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) {
        return base::failure("{}: is gone, and cannot be read back at byte {}: {}", path_.string(),
                             copy.size_, got < 0 ? system_message(errno) : "it ends there");
      }
      piece.resize(static_cast<std::size_t>(got));
      if (auto added = copy.append(piece); !added) return added;
    }
    return {};
  });
}

JournalFile::Place JournalFile::place() const {
  struct stat own {};
  struct stat found {};
  if (calls_->fstat(file_.get(), &own) != 0) return Place::kUnknown;
  if (calls_->lstat(path_.c_str(), &found) == 0)
    return own.st_nlink > 0 && own.st_dev == found.st_dev && own.st_ino == found.st_ino ? Place::kItself
                                                                                        : Place::kAnother;
  return errno == ENOENT ? Place::kNothing : Place::kUnknown;
}

void JournalFile::unlock() { static_cast<void>(calls_->flock(file_.get(), LOCK_UN)); }

base::Result<void> JournalFile::append(std::span<const std::byte> entries) {
  if (auto cut_back = cut(); !cut_back) return cut_back;
  reserve(size_ + entries.size());
  const std::size_t written = write_all(file_.get(), entries, *calls_);
  if (written == entries.size()) {
    size_ += written;
    return {};
  }
  auto failed = base::failure("{}: {} of {} bytes written at byte {}: {}", path_.string(), written,
                              entries.size(), size_, system_message(errno));
  // Back to the last whole entry, so that what follows is readable. What cannot be cut now is cut later.
  has_rest_ = written > 0;
  static_cast<void>(cut());
  return failed;
}

base::Result<void> JournalFile::sync() {
  if (calls_->fdatasync(file_.get()) != 0)
    return base::failure("{}: cannot be made durable: {}", path_.string(), system_message(errno));
  return {};
}

void JournalFile::cut_to(std::uint64_t size) {
  size_ = size;
  has_rest_ = true;
  static_cast<void>(cut());
}

void JournalFile::give_room_back() {
  has_rest_ = reserved_ > size_;
  static_cast<void>(cut());
}

base::Result<void> JournalFile::cut() {
  if (!has_rest_) return {};
  if (calls_->ftruncate(file_.get(), static_cast<off_t>(size_)) != 0)
    return base::failure("{}: cannot be cut back: {}", path_.string(), system_message(errno));
  has_rest_ = false;
  reserved_ = size_;  // Cutting gives the room behind the end away.
  return {};
}

void JournalFile::reserve(std::uint64_t size) {
  if (size <= reserved_) return;
  // Not every file system can; without it the disk is only full sooner.
  static_cast<void>(calls_->reserve(file_.get(), static_cast<off_t>(size_), static_cast<off_t>(kReserve)));
  reserved_ = size_ + kReserve;
}

}  // namespace stickslip::record
