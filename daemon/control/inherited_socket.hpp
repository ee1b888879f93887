/// \file
/// Sockets that the service manager opened before it started the daemon [sd_listen_fds(3)]: who connects
/// while the daemon is started, or started again, waits instead of being refused.
#pragma once

#include <filesystem>
#include <optional>

namespace stickslip::control {

/// A descriptor of the Unix socket that listens at that path, if there is one among them; the caller's to
/// close, and there again at the next call.
[[nodiscard]] std::optional<int> inherited_socket(const std::filesystem::path& path);

}  // namespace stickslip::control
