#include "drivers/comedi/comedi_errors.hpp"

#include <fmt/format.h>
#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

namespace stickslip::drivers {
namespace {

std::string user_name() {
  passwd entry{};
  passwd* found = nullptr;
  std::array<char, 4096> text{};
  if (::getpwuid_r(::geteuid(), &entry, text.data(), text.size(), &found) == 0 && found != nullptr)
    return found->pw_name;
  return fmt::format("{}", ::geteuid());
}

std::string group_name(gid_t group) {
  ::group entry{};
  ::group* found = nullptr;
  std::array<char, 4096> text{};
  if (::getgrgid_r(group, &entry, text.data(), text.size(), &found) == 0 && found != nullptr)
    return found->gr_name;
  return fmt::format("{}", group);
}

/// Message for a denied permission; it names the group that may use the device file.
std::string explain_permission(const std::string& device) {
  constexpr const char* kGroupOfThePackage = "iocard";
  constexpr mode_t kGroupMayUse = S_IRGRP | S_IWGRP;
  struct stat node {};
  const bool known = ::stat(device.c_str(), &node) == 0;
  if (known && (node.st_mode & kGroupMayUse) != kGroupMayUse) {
    return fmt::format(
        "{}: permission denied: no group may use it (mode {:04o}); package libcomedi0 has the udev rule that "
        "gives it "
        "to group {}: install it and plug the board in again",
        device, node.st_mode & 07777U, kGroupOfThePackage);
  }
  const std::string group = known ? group_name(node.st_gid) : kGroupOfThePackage;
  return fmt::format(
      "{}: permission denied; it is for group {}: add the user (\"sudo adduser {} {}\") and log in again; a "
      "service "
      "needs SupplementaryGroups={}",
      device, group, user_name(), group, group);
}

}  // namespace

std::string explain_comedi_error(const std::string& device, int error) {
  switch (error) {
    case EBUSY:
      return fmt::format(
          "{}: another program is using it; stop that program (\"fuser -v {}\" names it) and try again",
          device, device);
    case EACCES:
    case EPERM:
      return explain_permission(device);
    case ENOENT:
      return fmt::format(
          "{}: no such device; plug the board in or load its driver (\"cat /proc/comedi\" lists boards)",
          device);
    case ENODEV:
    case ENXIO:
      return fmt::format(
          "{}: no board behind this device; plug it in or configure it (\"cat /proc/comedi\" lists "
          "boards)",
          device);
    default:
      return fmt::format("{}: {}", device, std::generic_category().message(error));
  }
}

base::Error comedi_error(const std::string& device, int error) {
  const bool permission = error == EACCES || error == EPERM;
  const auto kind = error == EBUSY ? base::ErrorKind::kBusy
                    : permission   ? base::ErrorKind::kNoPermission
                                   : base::ErrorKind::kFailure;
  return {kind, explain_comedi_error(device, error)};
}

}  // namespace stickslip::drivers
