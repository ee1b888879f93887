#include "drivers/comedi/board_place.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <fstream>
#include <system_error>

#include "core/base/text.hpp"

namespace stickslip::drivers {
namespace {

namespace fs = std::filesystem;

/// "pci", "usb", …; empty for a folder that is no device.
std::string subsystem_of(const fs::path& device) {
  std::error_code error;
  return fs::read_symlink(device / "subsystem", error).filename().string();
}

/// First line of an attribute; empty if there is none.
std::string attribute(const fs::path& file) {
  std::ifstream stream{file};
  std::string line;
  std::getline(stream, line);
  return base::printable(line);
}

/// One part of udev's ID_PATH; empty if the device adds none.
std::string part_of_path(const std::string& subsystem, const std::string& name) {
  if (subsystem == "pci" || subsystem == "platform") return fmt::format("{}-{}", subsystem, name);
  // The number of the bus depends on the order in which controllers were found.
  if (subsystem == "usb") return fmt::format("usb-0:{}", name.substr(name.find('-') + 1));
  return {};
}

}  // namespace

BoardPlace place_in_sysfs(const fs::path& of_class, const fs::path& devices) {
  std::error_code error;
  const fs::path hardware = fs::canonical(of_class / "device", error);
  if (error) return {};
  const fs::path root = fs::canonical(devices, error);
  BoardPlace place;
  place.serial = attribute(hardware / "serial");
  // Drivers of USB boards attach to an interface of the device.
  if (place.serial.empty() && subsystem_of(hardware) == "usb")
    place.serial = attribute(hardware.parent_path() / "serial");
  std::string before;
  for (fs::path at = hardware; at != root && at.has_relative_path(); at = at.parent_path()) {
    const std::string subsystem = subsystem_of(at);
    if (subsystem.empty() || subsystem == before) continue;  // The hubs and bridges that lead there.
    before = subsystem;
    const std::string part = part_of_path(subsystem, at.filename());
    if (!part.empty()) place.bus_path = place.bus_path.empty() ? part : part + "-" + place.bus_path;
  }
  if (place.bus_path.empty()) place.bus_path = hardware.lexically_relative(root);
  return place;
}

BoardPlace place_of(const std::string& device) {
  struct stat node {};
  if (::stat(device.c_str(), &node) != 0 || !S_ISCHR(node.st_mode)) return {};
  return place_in_sysfs(fmt::format("/sys/dev/char/{}:{}", major(node.st_rdev), minor(node.st_rdev)));
}

}  // namespace stickslip::drivers
