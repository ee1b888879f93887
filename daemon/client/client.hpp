/// \file
/// The other side of the control socket, for the command line and for tests.
#pragma once

#include <chrono>
#include <filesystem>

#include "core/base/result.hpp"
#include "daemon/types/http.hpp"

namespace stickslip::client {

/// One request and its reply. Errors (kFailure): nobody listens, no answer in time.
[[nodiscard]] base::Result<daemon::HttpReply> request(const std::filesystem::path& socket,
                                                      const daemon::HttpRequest& request,
                                                      std::chrono::milliseconds timeout);

}  // namespace stickslip::client
