#include <fmt/format.h>

#include <memory>
#include <string>

#include "cli/daemon_parser.hpp"
#include "cli/manual/config_text.hpp"
#include "cli/manual/pages.hpp"
#include "cli/subcommands.hpp"

#include "core/base/version.hpp"

namespace stickslip::cli {
namespace {

constexpr const char* kConfig = "stickslipd.toml";

std::string page(const CLI::App& app, const std::string& name) {
  const std::string version = fmt::format("stickslip {}", base::kVersion);
  if (name == kTool) {
    return manual::command_page(
        app,
        {name, 1, version,
         "0 done, 1 the world did not allow it, 2 wrong usage or input, 74 the output cannot be written, 130 "
         "interrupted. \\fBverify\\fR and "
         "\\fBdoctor\\fR have more: see there.",
         ".TP\n/run/stickslip/control.sock\nwhere the daemon is asked\n.TP\n"
         "/etc/stickslip/stickslipd.toml\nits configuration",
         ".BR stickslipd (8),\n.BR stickslipd.toml (5)"});
  }
  if (name == kDaemon) {
    const DaemonParser daemon;
    return manual::command_page(
        daemon.app,
        {name, 8, version,
         "0 after a signal or the end of the input, 1 if the world did not allow it to work, 2 if "
         "it was told something wrong.",
         ".TP\n/etc/stickslip/stickslipd.toml\nthe configuration of the service\n.TP\n"
         "/var/lib/stickslip\nits working directory: records, outbox\n.TP\n"
         "/run/stickslip/control.sock\nwhere it is asked",
         ".BR stickslip (1),\n.BR stickslipd.toml (5)"});
  }
  return manual::config_page(manual::stickslipd_toml(),
                             {name, 5, version, {}, {}, ".BR stickslip (1),\n.BR stickslipd (8)"});
}

constexpr const char* kManHelp = R"(Examples:
  stickslip man | man -l -
  stickslip man stickslipd > stickslipd.8
  stickslip man stickslipd.toml > stickslipd.toml.5)";

}  // namespace

void add_man(CLI::App& app, Chosen& chosen) {
  const auto name = std::make_shared<std::string>(kTool);
  CLI::App* command = app.add_subcommand("man", "print a manual page, for man -l");
  command->footer(kManHelp);
  command->add_option("page", *name, "stickslip, stickslipd or stickslipd.toml")
      ->capture_default_str()
      ->check(CLI::IsMember({kTool, kDaemon, kConfig}))
      ->type_name("PAGE");
  choose(*command, chosen, [name, &app]() -> base::Result<std::string> { return page(app, *name); });
}

}  // namespace stickslip::cli
