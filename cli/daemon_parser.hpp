/// \file
/// The parser of stickslipd as that program has it, for its manual page and its completion.
#pragma once

#include <CLI/CLI.hpp>

#include "core/base/version.hpp"
#include "daemon/types/daemon_options.hpp"

namespace stickslip::cli {

inline constexpr const char* kTool = "stickslip";
inline constexpr const char* kDaemon = "stickslipd";

struct DaemonParser {
  CLI::App app{daemon::kDaemonPurpose, kDaemon};
  daemon::DaemonOptions options;
  DaemonParser() {
    daemon::declare_daemon_options(app, options);
    app.set_version_flag("--version", base::kVersion);
  }
};

}  // namespace stickslip::cli
