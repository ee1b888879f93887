/// \file
/// Client of the live stream, for the command line and for tests.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

#include "core/base/result.hpp"

namespace stickslip::client {

/// Calls `use` with each frame until `use` returns false or the daemon closes the stream; blocks. Errors:
/// kFailure if no daemon listens, or the stream is refused or breaks off.
[[nodiscard]] base::Result<void> listen_live(const std::filesystem::path& socket,
                                             const std::function<bool(std::string_view frame)>& use);

}  // namespace stickslip::client
