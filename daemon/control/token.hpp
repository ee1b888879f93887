/// \file
/// The token: the secret that authorises clients over TCP.
#pragma once

#include <filesystem>
#include <string>

#include "core/base/result.hpp"

namespace stickslip::control {

/// Reads the token file; makes it, with a random token and mode 0640, if it is absent. Read access to the
/// file grants use of the bench. Errors: kUsage if it holds no token or others may read it, kFailure if it
/// cannot be read or made.
[[nodiscard]] base::Result<std::string> load_token(const std::filesystem::path& file);

}  // namespace stickslip::control
