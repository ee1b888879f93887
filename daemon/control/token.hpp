/// \file
/// The secret that clients over TCP have to show.
#pragma once

#include <filesystem>
#include <string>

#include "core/base/result.hpp"

namespace stickslip::control {

/// Reads the file; makes it, with a new token, where there is none. It belongs to owner and group (0640): who
/// may read it may use the bench. Errors: kUsage if it holds no token or others may read it, kFailure if it
/// cannot be read or made.
[[nodiscard]] base::Result<std::string> load_token(const std::filesystem::path& file);

}  // namespace stickslip::control
