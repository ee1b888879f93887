/// \file
/// Input file given by the user. It distinguishes read errors of the system from damaged content.
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
#include <vector>

#include "core/base/result.hpp"
#include "core/record/file.hpp"
#include "core/record/file_calls.hpp"

namespace stickslip::record {

/// Why a file cannot be read, by errno, and what to do where that is known: one line without the file's name.
[[nodiscard]] std::string why_unreadable(int error);

/// A file open for reading. Copies share it; the last one closes it. Thread-safe except share() and load().
class GivenFile {
 public:
  /// Opens a regular file; never blocks.
  /// \param calls  must outlive the object.
  /// Errors, without the file's name: kUsage if it does not exist or is not a regular file, kNoPermission,
  /// kBusy, kFailure.
  [[nodiscard]] static base::Result<GivenFile> open(const std::filesystem::path& path,
                                                    const FileCalls& calls = system_calls());

  /// Takes a shared lock, which prevents writing by programs that lock (HDF5 does) while the file is open. No
  /// effect without locks in the file system. Errors: kBusy if a program is writing the file, else
  /// as open().
  [[nodiscard]] base::Result<void> share() const;

  /// Reads at most bytes.size() bytes from `position` on. \return their number, 0 at the end of the file; −1
  /// with errno on an error.
  [[nodiscard]] ssize_t read(std::span<std::byte> bytes, std::uint64_t position) const;
  /// Reads the whole file, so that a read error is found before HDF5 reads, which can crash on one. The
  /// content of a file of at most 1 MiB stays in memory for read(). To be called before other threads read.
  /// \return whether there was no read error; refused() has its errno.
  [[nodiscard]] bool load() const;

  /// Bytes when it was opened.
  [[nodiscard]] std::uint64_t size() const noexcept { return state_->size; }
  [[nodiscard]] int descriptor() const noexcept { return state_->file.get(); }
  /// errno of the latest failed read; 0 if none failed.
  [[nodiscard]] int refused() const noexcept { return state_->refused; }

 private:
  struct State {
    Descriptor file;
    std::uint64_t size;
    const FileCalls* calls;
    std::atomic<int> refused{0};
    std::vector<std::byte> kept;  ///< The whole file; empty: each read asks the system.
  };
  explicit GivenFile(std::shared_ptr<State> state) : state_(std::move(state)) {}
  std::shared_ptr<State> state_;
};

/// Opens a file that HDF5 is to read: open(), share() and load(). Does not check that it is one (is_hdf5()).
/// Errors as theirs; a read error as in open().
[[nodiscard]] base::Result<GivenFile> open_shared(const std::filesystem::path& path,
                                                  const FileCalls& calls = system_calls());

}  // namespace stickslip::record
