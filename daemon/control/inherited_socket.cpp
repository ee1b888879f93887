#include "daemon/control/inherited_socket.hpp"

#include <fcntl.h>
#include <sys/socket.h>
#include <systemd/sd-daemon.h>

namespace stickslip::control {

std::optional<int> inherited_socket(const std::filesystem::path& path) {
  const std::filesystem::path absolute = std::filesystem::absolute(path);
  const int count = sd_listen_fds(0);
  for (int socket = SD_LISTEN_FDS_START; socket < SD_LISTEN_FDS_START + count; ++socket) {
    if (sd_is_socket_unix(socket, SOCK_STREAM, 1, absolute.c_str(), absolute.native().size()) <= 0) continue;
    // Programs that the daemon starts do not get it.
    const int copy = ::fcntl(socket, F_DUPFD_CLOEXEC, 0);
    if (copy >= 0) return copy;
  }
  return std::nullopt;
}

}  // namespace stickslip::control
