/// \file
/// Text files that are whole or not there.
///
/// The text is built in a file beside the one that is asked for, under a name that cannot be known
/// beforehand (PATH.UUID.part), which is made anew and never followed if it is a link. So nothing that lies
/// in the folder already can be overwritten. It is made durable, then renamed. A kill between the two leaves
/// a
/// `.part` that nothing reads and that can be removed.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string_view>

#include "core/base/result.hpp"

namespace stickslip::io {

/// Permissions of what everybody may read.
inline constexpr mode_t kEverybodyReads = 0644;

/// Writes the whole text to a file that did not exist. On any error no file is left. Whether `path` is free
/// can be asked before the work: record::check_publishable(). Errors: kUsage if `path` exists, else kFailure.
[[nodiscard]] base::Result<void> write_new_file(const std::filesystem::path& path, std::string_view text,
                                                mode_t mode = kEverybodyReads);

}  // namespace stickslip::io
