/// \file
/// Where a board is plugged in, and its serial number, as sysfs tells them. Neither changes when the kernel
/// gives the board another device file.
#pragma once

#include <filesystem>
#include <string>

namespace stickslip::drivers {

struct BoardPlace {
  std::string serial;  ///< Of a USB board; empty if it has none.
  /// As udev's ID_PATH for boards on PCI, USB and the platform bus, such as "pci-0000:00:14.0-usb-0:2:1.0";
  /// else the path below /sys/devices. Empty for a board that was attached by comedi_config.
  std::string bus_path;

  bool operator==(const BoardPlace&) const = default;
};

/// \param device  a device file, or a link to one.
/// \return empty texts if there is no such device.
[[nodiscard]] BoardPlace place_of(const std::string& device);

/// \param of_class  the device's folder in sysfs, such as /sys/class/comedi/comedi0.
/// \param devices  the folder of all devices.
[[nodiscard]] BoardPlace place_in_sysfs(const std::filesystem::path& of_class,
                                        const std::filesystem::path& devices = "/sys/devices");

}  // namespace stickslip::drivers
