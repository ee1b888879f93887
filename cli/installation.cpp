#include "cli/installation.hpp"

#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

namespace stickslip::cli {
namespace {

constexpr const char* kInstalledFolder = "/var/lib/stickslip";

}  // namespace

void add_installation_options(CLI::App& command, Installation& installation) {
  command.add_option("--config", installation.config, "the daemon's configuration")
      ->capture_default_str()
      ->type_name("FILE");
  command
      .add_option(
          "--folder", installation.folder,
          "where the daemon runs, for relative names in it; default: /var/lib/stickslip for the installed "
          "configuration, else here")
      ->type_name("DIR");
}

base::Result<std::string> enter(const Installation& installation) {
  std::error_code error;
  const std::filesystem::path config = std::filesystem::absolute(installation.config, error);
  std::string folder = installation.folder;
  if (folder.empty() && installation.config == kInstalledConfig) folder = kInstalledFolder;
  if (!folder.empty() && ::chdir(folder.c_str()) != 0 && !installation.folder.empty())
    return base::usage_error("--folder {}: {}", folder, std::generic_category().message(errno));
  return installation.folder.empty() ? installation.config : config.string();
}

}  // namespace stickslip::cli
