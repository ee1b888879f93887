/// \file
/// Client of the control socket, for the command line and for tests.
#pragma once

#include <chrono>
#include <filesystem>

#include "core/base/result.hpp"
#include "daemon/types/http.hpp"

namespace stickslip::client {

/// Sends a request; blocks until the reply is there. Errors: kFailure if no daemon listens or no reply comes
/// in time.
[[nodiscard]] base::Result<daemon::HttpReply> request(const std::filesystem::path& socket,
                                                      const daemon::HttpRequest& request,
                                                      std::chrono::milliseconds timeout);

}  // namespace stickslip::client
