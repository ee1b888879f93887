/// \file
/// Text files that people ask for.
#pragma once

#include <filesystem>
#include <string_view>

#include "core/base/result.hpp"

namespace stickslip::daemon {

/// Writes the whole text to a file that did not exist: built as PATH.part, made durable, renamed. On any
/// error no file is left. Whether `path` is free can be asked before the work: record::check_publishable().
/// Errors: kUsage if `path` exists, else kFailure.
[[nodiscard]] base::Result<void> write_new_file(const std::filesystem::path& path, std::string_view text);

}  // namespace stickslip::daemon
