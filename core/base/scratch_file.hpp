/// \file
/// An unnamed temporary file for data that do not fit into memory; it disappears with its owner.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace stickslip::base {

/// An unnamed temporary file in a folder, the current one if the path is empty. Constructor, write() and
/// read() throw std::system_error, which names the operation and the folder.
class ScratchFile {
 public:
  explicit ScratchFile(const std::filesystem::path& folder);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  void write(std::uint64_t position, std::span<const std::byte> bytes);
  /// \param bytes  must have been written before.
  void read(std::uint64_t position, std::span<std::byte> bytes) const;

 private:
  std::filesystem::path folder_;
  int descriptor_ = -1;
};

}  // namespace stickslip::base
