/// \file
/// Sockets that the service manager opened before it started the daemon [sd_listen_fds(3)]. Clients that
/// connect during a start or restart wait instead of being refused.
#pragma once

#include <filesystem>
#include <optional>

namespace stickslip::control {

/// A duplicate descriptor of the inherited Unix socket that listens at `path`, or nothing. The caller closes
/// it; the next call returns another one.
[[nodiscard]] std::optional<int> inherited_socket(const std::filesystem::path& path);

}  // namespace stickslip::control
