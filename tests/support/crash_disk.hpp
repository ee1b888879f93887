/// \file
/// A disk whose power is cut: every change of a file is recorded through the table of calls, and any state
/// that the disk may be in at any moment is made again.
///
///     CrashDisk disk;                       // writes go to the real file system and into the log
///     … JournalWriter::create(path, header, disk) …
///     disk.promise("two scans");            // what has to be there from now on
///     for (std::size_t cut = 0; cut <= disk.size(); ++cut) disk.restore(cut, random, folder);
///
/// The model is what POSIX leaves open, worse than what ext4 does: of a file all that was written since its
/// last fsync may be there or not, page by page, in any combination, old content or zeros in its place; each
/// change of a folder since the last fsync of that folder may be there or not. Sizes end anywhere up to what
/// was written.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "core/record/file_calls.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::test {

/// Hands every call to the system; tests override what they watch or refuse.
class ForwardingCalls : public record::FileCalls {
 public:
  int open(const char* path, int flags, mode_t mode) const override {
    return system().open(path, flags, mode);
  }
  ssize_t write(int file, const void* bytes, std::size_t size) const override {
    return system().write(file, bytes, size);
  }
  ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t position) const override {
    return system().pwrite(file, bytes, size, position);
  }
  int ftruncate(int file, off_t size) const override { return system().ftruncate(file, size); }
  int reserve(int file, off_t position, off_t size) const override {
    return system().reserve(file, position, size);
  }
  int fsync(int file) const override { return system().fsync(file); }
  int fdatasync(int file) const override { return system().fdatasync(file); }
  int rename_to_new(const char* from, const char* to) const override {
    return system().rename_to_new(from, to);
  }
  ssize_t pread(int file, void* bytes, std::size_t size, off_t position) const override {
    return system().pread(file, bytes, size, position);
  }
  int flock(int file, int operation) const override { return system().flock(file, operation); }
  int fstat(int file, struct ::stat* found) const override { return system().fstat(file, found); }
  int lstat(const char* path, struct ::stat* found) const override { return system().lstat(path, found); }
  int rename(const char* from, const char* to) const override { return system().rename(from, to); }
  int link(const char* from, const char* to) const override { return system().link(from, to); }
  int unlink(const char* path) const override { return system().unlink(path); }
  int mkdir(const char* path, mode_t mode) const override { return system().mkdir(path, mode); }
  std::int64_t room(const char* folder) const override { return system().room(folder); }

 protected:
  static const record::FileCalls& system() { return record::system_calls(); }
};

class CrashDisk final : public ForwardingCalls {
 public:
  // Of the file system: what it does not know is refused.
  bool knows_rename_to_new = true;
  bool knows_link = true;

  /// Changes so far.
  [[nodiscard]] std::size_t size() const { return log_.size(); }
  /// From now on it has to be so. \return the number of changes before.
  std::size_t promise() const { return log_.size(); }

  /// Makes in the empty `folder` one of the states in which a power cut after the first `cut` changes may
  /// leave the disk.
  void restore(std::size_t cut, std::mt19937_64& random, const std::filesystem::path& folder) const {
    std::map<std::string, int> names;            // As they are on the disk.
    std::map<int, std::string> content;          // As it is on the disk.
    std::vector<Change> names_pending;           // Since the folder was synced.
    std::map<int, std::vector<Change>> pending;  // Since each file was synced.
    for (std::size_t i = 0; i < cut; ++i) {
      const Change& change = log_[i];
      switch (change.kind) {
        case Kind::kCreate:
        case Kind::kRename:
        case Kind::kUnlink:
          names_pending.push_back(change);
          break;
        case Kind::kWrite:
        case Kind::kTruncate:
          pending[change.file].push_back(change);
          break;
        case Kind::kSync:
          for (const Change& done : pending[change.file]) apply(done, content[done.file]);
          pending[change.file].clear();
          break;
        case Kind::kSyncFolder:
          for (const Change& done : names_pending) apply(done, names);
          names_pending.clear();
          break;
      }
    }
    // What was not synced: each change of a name, each page, by the toss of a coin. A coin of its own for
    // each state says how likely: all, none and every mixture come up.
    const double kept = std::uniform_real_distribution<double>{0.0, 1.0}(random);
    std::bernoulli_distribution keep{kept < 0.15 ? 0.0 : kept > 0.85 ? 1.0 : kept};
    for (const Change& change : names_pending) {
      if (keep(random)) apply(change, names);
    }
    for (auto& [file, changes] : pending) {
      for (const Change& change : changes) {
        for (const Change& page : pages_of(change)) {
          if (keep(random)) apply(page, content[file]);
        }
      }
    }
    for (const auto& [name, file] : names) write_content(folder / name, content[file]);
  }

  // The table of calls.

  int open(const char* path, int flags, mode_t mode) const override {
    const bool existed = ::access(path, F_OK) == 0;
    const int descriptor = system().open(path, flags, mode);
    if (descriptor < 0) return descriptor;
    const std::string name = std::filesystem::path{path}.filename().string();
    if (std::filesystem::is_directory(path)) {
      open_[descriptor] = kFolder;
      return descriptor;
    }
    if (!existed) {
      names_[name] = ++latest_file_;
      log_.push_back({Kind::kCreate, latest_file_, 0, {}, name, {}});
    } else if ((flags & O_TRUNC) != 0) {
      log_.push_back({Kind::kTruncate, names_.at(name), 0, {}, {}, {}});
    }
    open_[descriptor] = names_.at(name);
    return descriptor;
  }
  ssize_t write(int file, const void* bytes, std::size_t size) const override {
    const off_t position = ::lseek(file, 0, SEEK_END);  // O_APPEND.
    return logged(system().write(file, bytes, size), file, bytes, position);
  }
  ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t position) const override {
    return logged(system().pwrite(file, bytes, size, position), file, bytes, position);
  }
  int ftruncate(int file, off_t size) const override {
    log_.push_back({Kind::kTruncate, open_.at(file), static_cast<std::uint64_t>(size), {}, {}, {}});
    return system().ftruncate(file, size);
  }
  int reserve(int, off_t, off_t) const override { return 0; }
  // To be durable is to be in the log as such; the real disk need not be waited for.
  int fsync(int file) const override {
    const int what = open_.at(file);
    log_.push_back({what == kFolder ? Kind::kSyncFolder : Kind::kSync, what, 0, {}, {}, {}});
    return 0;
  }
  int fdatasync(int file) const override { return fsync(file); }
  int rename_to_new(const char* from, const char* to) const override {
    if (!knows_rename_to_new) return errno = EINVAL, -1;
    return renamed(system().rename_to_new(from, to), from, to);
  }
  int rename(const char* from, const char* to) const override {
    return renamed(system().rename(from, to), from, to);
  }
  int link(const char* from, const char* to) const override {
    if (!knows_link) return errno = EPERM, -1;
    const int status = system().link(from, to);
    if (status == 0) {
      const int file = names_.at(name_of(from));
      names_[name_of(to)] = file;
      log_.push_back({Kind::kCreate, file, 0, {}, name_of(to), {}});
    }
    return status;
  }
  int unlink(const char* path) const override {
    const int status = system().unlink(path);
    const std::string name = std::filesystem::path{path}.filename().string();
    if (status == 0) log_.push_back({Kind::kUnlink, names_.at(name), 0, {}, name, {}});
    names_.erase(name);
    return status;
  }

 private:
  enum class Kind { kCreate, kWrite, kTruncate, kSync, kSyncFolder, kRename, kUnlink };
  struct Change {
    Kind kind;
    int file;
    std::uint64_t position;  ///< Of a write; the new size of a truncation.
    std::string bytes;
    std::string name;
    std::string new_name;
  };
  static constexpr int kFolder = 0;
  static constexpr std::uint64_t kPage = 4096;

  static std::string name_of(const char* path) { return std::filesystem::path{path}.filename().string(); }

  int renamed(int status, const char* from, const char* to) const {
    if (status == 0) {
      const std::string old = name_of(from);
      log_.push_back({Kind::kRename, names_.at(old), 0, {}, old, name_of(to)});
      names_[name_of(to)] = names_.at(old);
      names_.erase(old);
    }
    return status;
  }

  ssize_t logged(ssize_t done, int file, const void* bytes, off_t position) const {
    if (done > 0) {
      log_.push_back({Kind::kWrite,
                      open_.at(file),
                      static_cast<std::uint64_t>(position),
                      std::string(static_cast<const char*>(bytes), static_cast<std::size_t>(done)),
                      {},
                      {}});
    }
    return done;
  }

  /// What of a change reaches the disk as a whole.
  static std::vector<Change> pages_of(const Change& change) {
    if (change.kind != Kind::kWrite) return {change};
    std::vector<Change> pages;
    for (std::uint64_t at = 0; at < change.bytes.size();) {
      const std::uint64_t position = change.position + at;
      const std::uint64_t count = std::min<std::uint64_t>(kPage - position % kPage, change.bytes.size() - at);
      pages.push_back({Kind::kWrite, change.file, position, change.bytes.substr(at, count), {}, {}});
      at += count;
    }
    return pages;
  }

  static void apply(const Change& change, std::string& content) {
    if (change.kind == Kind::kTruncate) {
      content.resize(change.position, '\0');
      return;
    }
    content.resize(std::max<std::size_t>(content.size(), change.position + change.bytes.size()), '\0');
    content.replace(change.position, change.bytes.size(), change.bytes);
  }

  static void apply(const Change& change, std::map<std::string, int>& names) {
    if (change.kind == Kind::kUnlink || change.kind == Kind::kRename) names.erase(change.name);
    if (change.kind == Kind::kRename) names[change.new_name] = change.file;
    if (change.kind == Kind::kCreate) names[change.name] = change.file;
  }

  mutable std::vector<Change> log_;
  mutable std::map<int, int> open_;           ///< Descriptor → file.
  mutable std::map<std::string, int> names_;  ///< As they are now.
  mutable int latest_file_ = kFolder;
};

/// Nothing is waited for: what a restored disk is recovered with.
class HastyCalls final : public ForwardingCalls {
 public:
  int fsync(int) const override { return 0; }
  int fdatasync(int) const override { return 0; }
};

}  // namespace stickslip::test
