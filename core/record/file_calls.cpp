#include "core/record/file_calls.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/statvfs.h>
#include <unistd.h>

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
  ssize_t pread(int file, void* bytes, std::size_t size, off_t position) const override {
    return ::pread(file, bytes, size, position);
  }
  int flock(int file, int operation) const override { return ::flock(file, operation); }
  int fstat(int file, struct ::stat* found) const override { return ::fstat(file, found); }
  int lstat(const char* path, struct ::stat* found) const override { return ::lstat(path, found); }
  int ftruncate(int file, off_t size) const override { return ::ftruncate(file, size); }
  int reserve(int file, off_t position, off_t size) const override {
    return ::fallocate(file, FALLOC_FL_KEEP_SIZE, position, size);
  }
  int fsync(int file) const override { return ::fsync(file); }
  int fdatasync(int file) const override { return ::fdatasync(file); }
  int rename_to_new(const char* from, const char* to) const override {
    return ::renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE);
  }
  int rename(const char* from, const char* to) const override { return std::rename(from, to); }
  int link(const char* from, const char* to) const override { return ::link(from, to); }
  int unlink(const char* path) const override { return ::unlink(path); }
  int mkdir(const char* path, mode_t mode) const override { return ::mkdir(path, mode); }
  std::int64_t room(const char* folder) const override {
    struct statvfs found {};
    // A file system without any blocks is one that does not tell.
    if (::statvfs(folder, &found) != 0 || found.f_blocks == 0) return -1;
    return static_cast<std::int64_t>(found.f_bavail) * static_cast<std::int64_t>(found.f_frsize);
  }
};

}  // namespace

const FileCalls& system_calls() {
  static const SystemCalls calls;
  return calls;
}

}  // namespace stickslip::record
