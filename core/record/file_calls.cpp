#include "core/record/file_calls.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

namespace stickslip::record {
namespace {

class SystemCalls final : public FileCalls {
 public:
  int open(const char* path, int flags, mode_t mode) const override { return ::open(path, flags, mode); }
  ssize_t write(int file, const void* bytes, std::size_t size) const override {
    return ::write(file, bytes, size);
  }
  ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t position) const override {
    return ::pwrite(file, bytes, size, position);
  }
  int ftruncate(int file, off_t size) const override { return ::ftruncate(file, size); }
  int reserve(int file, off_t position, off_t size) const override {
    return ::fallocate(file, FALLOC_FL_KEEP_SIZE, position, size);
  }
  int fsync(int file) const override { return ::fsync(file); }
  int fdatasync(int file) const override { return ::fdatasync(file); }
  int rename_to_new(const char* from, const char* to) const override {
    // The flag closes the moment between looking and renaming; some file systems do not know it (EINVAL).
    if (::renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0) return 0;
    if (errno != EINVAL) return -1;
    struct stat found {};
    if (::lstat(to, &found) == 0) {
      errno = EEXIST;
      return -1;
    }
    return std::rename(from, to);
  }
  int unlink(const char* path) const override { return ::unlink(path); }
  int mkdir(const char* path, mode_t mode) const override { return ::mkdir(path, mode); }
  std::int64_t room(const char* folder) const override {
    struct statvfs found {};
    if (::statvfs(folder, &found) != 0) return -1;
    return static_cast<std::int64_t>(found.f_bavail) * static_cast<std::int64_t>(found.f_frsize);
  }
};

}  // namespace

const FileCalls& system_calls() {
  static const SystemCalls calls;
  return calls;
}

}  // namespace stickslip::record
