/// \file
/// Files that somebody names to be read. Opening one waits for nobody: a FIFO or a device is refused by name.
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

/// Why a thing of that kind is not read ("is a FIFO, not a regular file"); empty for a regular file.
[[nodiscard]] std::string why_not_regular(mode_t mode);

struct RegularFile {
  Descriptor file;         ///< Its offset is 0.
  std::uint64_t size = 0;  ///< Bytes; of a pipe 0.
};

/// Errors, with the path: kUsage if it is not there or no regular file, kFailure if the system refuses it.
[[nodiscard]] Result<RegularFile> open_regular(const std::filesystem::path& path);

/// As open_regular(), and also what this process was given open, of any kind but a folder: /dev/stdin, and
/// /dev/fd/63 as a shell's <(command) names it.
[[nodiscard]] Result<RegularFile> open_text(const std::filesystem::path& path);

/// The whole content, or its first `longest` bytes. Errors as open_text(); kFailure if it cannot be read.
[[nodiscard]] Result<std::string> read_text(const std::filesystem::path& path,
                                            std::size_t longest = std::numeric_limits<std::size_t>::max());

}  // namespace stickslip::base
