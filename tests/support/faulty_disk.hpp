/// \file
/// A disk that refuses, forgets or takes its time.
#pragma once

#include <atomic>
#include <cerrno>
#include <functional>
#include <limits>
#include <thread>

#include "tests/support/crash_disk.hpp"

namespace stickslip::test {

class FaultyDisk final : public ForwardingCalls {
 public:
  /// Calls that change a file and may be refused, so far.
  [[nodiscard]] int calls() const { return calls_; }

  /// Refuses these calls, counted from 0, with an error; the first of them, if it is a write, after half of
  /// its bytes.
  void refuse(int first, int count, int error) {
    calls_ = 0;
    first_ = first;
    end_ = first > std::numeric_limits<int>::max() - count ? std::numeric_limits<int>::max() : first + count;
    error_ = error;
  }
  /// From now on, until works_again().
  void refuse(int error) { refuse(0, std::numeric_limits<int>::max(), error); }
  void works_again() { refuse(0, 0, 0); }
  /// Writes and syncs wait for this first.
  void hold(std::function<void()> wait) { wait_ = std::move(wait); }
  /// Reads count as calls, and may be refused.
  void count_reads() { counts_reads_ = true; }
  void set_room(std::int64_t bytes) { room_ = bytes; }

  int open(const char* path, int flags, mode_t mode) const override {
    if ((flags & O_CREAT) != 0 && refused()) return -1;
    return ForwardingCalls::open(path, flags, mode);
  }
  ssize_t write(int file, const void* bytes, std::size_t size) const override {
    wait();
    const bool is_first = calls_ == first_ && first_ < end_;
    if (!refused()) return ForwardingCalls::write(file, bytes, size);
    return is_first && size > 1 ? ForwardingCalls::write(file, bytes, size / 2) : -1;
  }
  ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t position) const override {
    wait();
    return refused() ? -1 : ForwardingCalls::pwrite(file, bytes, size, position);
  }
  int ftruncate(int file, off_t size) const override {
    return refused() ? -1 : ForwardingCalls::ftruncate(file, size);
  }
  int reserve(int, off_t, off_t) const override { return 0; }
  // Nothing is waited for: it is the order that is tried.
  int fsync(int) const override { return wait(), refused() ? -1 : 0; }
  int fdatasync(int) const override { return wait(), refused() ? -1 : 0; }
  int rename_to_new(const char* from, const char* to) const override {
    return refused() ? -1 : ForwardingCalls::rename_to_new(from, to);
  }
  int unlink(const char* path) const override { return refused() ? -1 : ForwardingCalls::unlink(path); }
  int mkdir(const char* path, mode_t mode) const override {
    return refused() ? -1 : ForwardingCalls::mkdir(path, mode);
  }
  ssize_t pread(int file, void* bytes, std::size_t size, off_t position) const override {
    return counts_reads_ && refused() ? -1 : ForwardingCalls::pread(file, bytes, size, position);
  }
  std::int64_t room(const char* folder) const override {
    return room_ >= 0 ? room_.load() : ForwardingCalls::room(folder);
  }

 private:
  bool refused() const {
    const int call = calls_++;
    if (call < first_ || call >= end_) return false;
    errno = error_;
    return true;
  }
  void wait() const {
    if (wait_) wait_();
  }

  mutable std::atomic<int> calls_{0};
  std::atomic<int> first_{0};
  std::atomic<int> end_{0};
  std::atomic<int> error_{0};
  std::atomic<std::int64_t> room_{-1};
  bool counts_reads_ = false;
  std::function<void()> wait_;
};

}  // namespace stickslip::test
