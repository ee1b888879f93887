/// \file
/// A file that somebody gives to be read. What the system refuses is kept apart from what the content is:
/// only content can be damaged.
///
///     auto file = GivenFile::open(path);       // else: no such file, no permission, cannot be read now …
///     if (auto locked = file->share(); !locked) …  // somebody is writing it
///     … read …
///     if (file->refused() != 0) …              // the disk, not the content, is why something failed
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "core/base/result.hpp"
#include "core/record/file.hpp"
#include "core/record/file_calls.hpp"

namespace stickslip::record {

/// Why a file cannot be read, by errno, and what to do: one line without the file's name.
[[nodiscard]] std::string why_unreadable(int error);

/// Copies are the same open file. Thread-safe but for share().
class GivenFile {
 public:
  /// A regular file; opening waits for nobody. \param calls  outlives it. Errors, without the file's name:
  /// kUsage if it is not there or no file, kNoPermission, kFailure.
  [[nodiscard]] static base::Result<GivenFile> open(const std::filesystem::path& path,
                                                    const FileCalls& calls = system_calls());

  /// Keeps those who lock what they write (HDF5 does) from writing it while it is open. Where the file system
  /// has no locks nobody can. Errors: kBusy if somebody writes it, without the file's name.
  [[nodiscard]] base::Result<void> share() const;

  /// At most bytes.size() bytes from `position` on. \return how many; −1 and errno if the system refused.
  [[nodiscard]] ssize_t read(std::span<std::byte> bytes, std::uint64_t position) const;
  /// Reads all of it and forgets it. \return whether the system lets it be read.
  [[nodiscard]] bool is_readable() const;

  [[nodiscard]] std::uint64_t size() const noexcept { return state_->size; }
  [[nodiscard]] int descriptor() const noexcept { return state_->file.get(); }
  /// errno of the latest read that the system refused; 0 if none was.
  [[nodiscard]] int refused() const noexcept { return state_->refused; }

 private:
  struct State {
    Descriptor file;
    std::uint64_t size;
    const FileCalls* calls;
    std::atomic<int> refused{0};
  };
  explicit GivenFile(std::shared_ptr<State> state) : state_(std::move(state)) {}
  std::shared_ptr<State> state_;
};

/// The same of a record: open(), share() and is_readable(), for HDF5 crashes where a read is refused.
[[nodiscard]] base::Result<GivenFile> open_shared(const std::filesystem::path& path,
                                                  const FileCalls& calls = system_calls());

}  // namespace stickslip::record
