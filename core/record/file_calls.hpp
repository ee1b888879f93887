/// \file
/// Table of the system calls for journals and records, which tests can observe, refuse or delay
/// (tests/support/*_disk.hpp). Each function makes one system call. All writes of journals and records go
/// through it, those of HDF5 too (hdf_driver.hpp). Not all other calls do, such as openings for reading and
/// questions of status.
#pragma once

#include <sys/stat.h>
#include <sys/types.h>

#include <cstddef>
#include <cstdint>

namespace stickslip::record {

/// System calls. Each function behaves as the POSIX function of its name: −1 and errno on failure.
/// Thread-safe.
class FileCalls {
 public:
  virtual ~FileCalls() = default;

  virtual int open(const char* path, int flags, mode_t mode) const = 0;
  virtual ssize_t write(int file, const void* bytes, std::size_t size) const = 0;
  virtual ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t position) const = 0;
  virtual int ftruncate(int file, off_t size) const = 0;
  /// Reserves disk space without changing the size (FALLOC_FL_KEEP_SIZE).
  virtual int reserve(int file, off_t position, off_t size) const = 0;
  virtual int fsync(int file) const = 0;
  virtual int fdatasync(int file) const = 0;
  virtual ssize_t pread(int file, void* bytes, std::size_t size, off_t position) const = 0;
  virtual int flock(int file, int operation) const = 0;
  /// Status of an open file, and of a path; lstat() does not follow a link.
  virtual int fstat(int file, struct ::stat* found) const = 0;
  virtual int lstat(const char* path, struct ::stat* found) const = 0;
  /// Renames without replacing (RENAME_NOREPLACE): EEXIST if `to` exists, EINVAL if the file system does not
  /// support it; rename_to_new() of file.hpp has fallbacks for that.
  virtual int rename_to_new(const char* from, const char* to) const = 0;
  /// Renames; replaces an existing file.
  virtual int rename(const char* from, const char* to) const = 0;
  /// Hard link; EEXIST if `to` exists.
  virtual int link(const char* from, const char* to) const = 0;
  virtual int unlink(const char* path) const = 0;
  virtual int mkdir(const char* path, mode_t mode) const = 0;
  /// Bytes that an unprivileged user can still write to the file system of a folder; −1 if unknown, where
  /// errno is not always set.
  virtual std::int64_t room(const char* folder) const = 0;
};

/// The real system calls.
[[nodiscard]] const FileCalls& system_calls();

}  // namespace stickslip::record
