/// \file
/// A file system that lacks something, or that cannot be reached for the moment.
///
///     LackingDisk disk;
///     disk.flock_error = ENOLCK;   // NFS without a lock manager
///     … read_record(path, disk) …
#pragma once

#include <sys/stat.h>

#include <cerrno>
#include <string>

#include "tests/support/crash_disk.hpp"

namespace stickslip::test {

/// Each call fails with the error of its kind, if it is not 0; the others are the system's.
class LackingDisk : public ForwardingCalls {
 public:
  int open_error = 0;           ///< Of files that are there and are to be read.
  int pread_error = 0;          ///< Of reads from pread_from on.
  off_t pread_from = 0;         ///< Bytes.
  int flock_error = 0;          ///< Of all locks.
  int rename_to_new_error = 0;  ///< Of RENAME_NOREPLACE.
  int link_error = 0;
  int create_error = 0;
  int fsync_error = 0;         ///< Of files.
  int folder_fsync_error = 0;  ///< Of folders.
  bool tells_room = true;

  int open(const char* path, int flags, mode_t mode) const override {
    if ((flags & O_CREAT) != 0 ? fails(create_error) : fails(open_error)) return -1;
    return ForwardingCalls::open(path, flags, mode);
  }
  ssize_t pread(int file, void* bytes, std::size_t size, off_t position) const override {
    if (position + static_cast<off_t>(size) > pread_from && fails(pread_error)) return -1;
    return ForwardingCalls::pread(file, bytes, size, position);
  }
  int flock(int file, int operation) const override {
    return fails(flock_error) ? -1 : ForwardingCalls::flock(file, operation);
  }
  int rename_to_new(const char* from, const char* to) const override {
    return fails(rename_to_new_error) ? -1 : ForwardingCalls::rename_to_new(from, to);
  }
  int link(const char* from, const char* to) const override {
    return fails(link_error) ? -1 : ForwardingCalls::link(from, to);
  }
  int fsync(int file) const override {
    struct stat found {};
    const bool is_folder = ::fstat(file, &found) == 0 && S_ISDIR(found.st_mode);
    return fails(is_folder ? folder_fsync_error : fsync_error) ? -1 : 0;
  }
  int fdatasync(int) const override { return fails(fsync_error) ? -1 : 0; }
  std::int64_t room(const char* folder) const override {
    return tells_room ? ForwardingCalls::room(folder) : -1;
  }

 private:
  static bool fails(int error) {
    if (error != 0) errno = error;
    return error != 0;
  }
};

}  // namespace stickslip::test
