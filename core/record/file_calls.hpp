/// \file
/// The system calls that read and change files of records, as a table that a test can watch, refuse or delay
/// (tests/support/*_disk.hpp). Nothing is decided here: one call, one function of the system. All that
/// writes journals and records goes through it, HDF5 too (hdf_driver.hpp).
#pragma once

#include <sys/stat.h>
#include <sys/types.h>

#include <cstddef>
#include <cstdint>

namespace stickslip::record {

/// As the functions of POSIX: −1 and errno on failure. May be called from several threads.
class FileCalls {
 public:
  virtual ~FileCalls() = default;

  virtual int open(const char* path, int flags, mode_t mode) const = 0;
  virtual ssize_t write(int file, const void* bytes, std::size_t size) const = 0;
  virtual ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t position) const = 0;
  virtual int ftruncate(int file, off_t size) const = 0;
  /// Room behind the end, without changing the size (FALLOC_FL_KEEP_SIZE).
  virtual int reserve(int file, off_t position, off_t size) const = 0;
  virtual int fsync(int file) const = 0;
  virtual int fdatasync(int file) const = 0;
  virtual ssize_t pread(int file, void* bytes, std::size_t size, off_t position) const = 0;
  virtual int flock(int file, int operation) const = 0;
  /// Of what is open, and of what stands at a path: a link itself.
  virtual int fstat(int file, struct ::stat* found) const = 0;
  virtual int lstat(const char* path, struct ::stat* found) const = 0;
  /// Renames without replacing (RENAME_NOREPLACE): EEXIST if `to` is there, EINVAL where the file system does
  /// not know it. See rename_to_new() of file.hpp, which works there too.
  virtual int rename_to_new(const char* from, const char* to) const = 0;
  /// Renames; what is there is replaced.
  virtual int rename(const char* from, const char* to) const = 0;
  /// A second name of the same file: EEXIST if `to` is there.
  virtual int link(const char* from, const char* to) const = 0;
  virtual int unlink(const char* path) const = 0;
  virtual int mkdir(const char* path, mode_t mode) const = 0;
  /// Bytes that may still be written in a folder, or −1.
  virtual std::int64_t room(const char* folder) const = 0;
};

/// Those of the system.
[[nodiscard]] const FileCalls& system_calls();

}  // namespace stickslip::record
