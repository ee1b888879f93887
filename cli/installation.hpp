/// \file
/// Which installation `stickslip doctor` and `stickslip bundle` look at.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "core/base/result.hpp"

namespace stickslip::cli {

inline constexpr const char* kInstalledConfig = "/etc/stickslip/stickslipd.toml";

struct Installation {
  std::string config = kInstalledConfig;
  std::string folder;  ///< Where the daemon runs; empty: see the option's help.
};

/// Adds --config and --folder. \param installation  outlives the parser.
void add_installation_options(CLI::App& command, Installation& installation);

/// Makes the daemon's folder the working directory of this process, so that relative names in the
/// configuration mean what they mean to the daemon. \return the configuration's path from there. Errors:
/// kUsage if --folder cannot be entered.
[[nodiscard]] base::Result<std::string> enter(const Installation& installation);

}  // namespace stickslip::cli
