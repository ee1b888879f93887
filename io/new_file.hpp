/// \file
/// Writes text files atomically: the file is complete or absent.
///
/// The text is written to a new file PATH.UUID.part, made durable, then renamed to PATH. The unpredictable
/// name and exclusive creation keep files and links in the folder from being overwritten or followed. A kill
/// before the rename leaves a `.part` file, which nothing reads; remove it.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string_view>

#include "core/base/result.hpp"

namespace stickslip::io {

/// Mode of a file that all users may read.
inline constexpr mode_t kEverybodyReads = 0644;

/// Writes the text to a new file, durably; blocks on the disk. On any error no file is left.
/// record::check_publishable() tells beforehand whether `path` is free. Errors: kUsage if `path` exists, else
/// kFailure.
[[nodiscard]] base::Result<void> write_new_file(const std::filesystem::path& path, std::string_view text,
                                                mode_t mode = kEverybodyReads);

}  // namespace stickslip::io
