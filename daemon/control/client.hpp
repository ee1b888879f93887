/// \file
/// The other side of the control socket, for the command line and for tests.
#pragma once

#include <chrono>
#include <filesystem>

#include "core/base/result.hpp"
#include "daemon/control/http.hpp"

namespace stickslip::daemon {

/// One request and its reply. Errors (kFailure): nobody listens, no answer in time.
[[nodiscard]] base::Result<HttpReply> request(const std::filesystem::path& socket, const HttpRequest& request,
                                              std::chrono::milliseconds timeout);

}  // namespace stickslip::daemon
