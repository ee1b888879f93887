/// \file
/// Opening of input files given by the user. Opening never blocks: a FIFO or a device is refused with its
/// kind, unless this process inherited it open (open_text()).
#pragma once

#include <sys/stat.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

#include "core/base/descriptor.hpp"
#include "core/base/result.hpp"

namespace stickslip::base {

/// Reason why a file of this mode is refused ("is a FIFO, not a regular file"); empty for a regular file.
[[nodiscard]] std::string why_not_regular(mode_t mode);

/// An open input file.
struct RegularFile {
  Descriptor file;         ///< Its offset is 0.
  std::uint64_t size = 0;  ///< Bytes; 0 for a pipe or a device.
};

/// Opens a regular file for reading. Errors, with the path: kUsage if it does not exist or is not a regular
/// file, kFailure if the system refuses, as it does for a socket.
[[nodiscard]] Result<RegularFile> open_regular(const std::filesystem::path& path);

/// As open_regular(), and also opens a pipe or a device that this process inherited open, if the path is
/// /dev/stdin or below /dev/fd/ or /proc/self/fd/, such as /dev/fd/63 from a shell's <(command). Reading such
/// a descriptor may block.
[[nodiscard]] Result<RegularFile> open_text(const std::filesystem::path& path);

/// Reads the whole content, or its first `longest` bytes. Errors as open_text(); kFailure if reading fails.
[[nodiscard]] Result<std::string> read_text(const std::filesystem::path& path,
                                            std::size_t longest = std::numeric_limits<std::size_t>::max());

}  // namespace stickslip::base
