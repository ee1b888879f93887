/// \file
/// A disk on which a folder is a file system of its own, and of which some calls cannot look or read.
#pragma once

#include <fmt/format.h>
#include <sys/stat.h>

#include <atomic>
#include <cerrno>
#include <filesystem>

#include "tests/support/crash_disk.hpp"

namespace stickslip::test {

class MovingDisk final : public ForwardingCalls {
 public:
  /// What is below this folder is on another device.
  void mount(const std::filesystem::path& folder, int device) {
    folder_ = folder.lexically_normal().string();
    device_ = device;
  }
  void unmount() { device_ = 0; }
  /// From now on lstat of what is below the folder of that name fails so; 0: it works again.
  void hide(const std::filesystem::path& folder, int error) {
    hidden_ = folder.lexically_normal().string();
    hidden_error_ = error;
  }
  /// From now on nothing can be read back; 0: it can again.
  void refuse_reads(int error) { read_error_ = error; }

  int lstat(const char* path, struct ::stat* found) const override {
    const std::string normal = std::filesystem::path{path}.lexically_normal().string();
    if (hidden_error_ != 0 && normal.starts_with(hidden_)) {
      errno = hidden_error_;
      return -1;
    }
    return on_device(ForwardingCalls::lstat(path, found), normal, found);
  }
  int fstat(int file, struct ::stat* found) const override {
    std::error_code error;
    const auto path = std::filesystem::read_symlink(fmt::format("/proc/self/fd/{}", file), error);
    return on_device(ForwardingCalls::fstat(file, found), path.string(), found);
  }
  ssize_t pread(int file, void* bytes, std::size_t size, off_t position) const override {
    if (read_error_ == 0) return ForwardingCalls::pread(file, bytes, size, position);
    errno = read_error_;
    return -1;
  }
  // Nothing is waited for.
  int fsync(int) const override { return 0; }
  int fdatasync(int) const override { return 0; }

 private:
  int on_device(int status, const std::string& path, struct ::stat* found) const {
    if (status == 0 && device_ != 0 && path.starts_with(folder_))
      found->st_dev += static_cast<dev_t>(device_);
    return status;
  }

  std::string folder_;
  std::string hidden_;
  std::atomic<int> device_{0};
  std::atomic<int> hidden_error_{0};
  std::atomic<int> read_error_{0};
};

}  // namespace stickslip::test
