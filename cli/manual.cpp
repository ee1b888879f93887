// Subcommands man and completion: pages and scripts made from the parsers themselves.

#include <fmt/format.h>

#include "cli/manual/completion.hpp"
#include "cli/manual/config_text.hpp"
#include "cli/manual/pages.hpp"
#include "cli/subcommands.hpp"

#include "core/base/version.hpp"
#include "daemon/types/daemon_options.hpp"

namespace stickslip::cli {
namespace {

constexpr const char* kTool = "stickslip";
constexpr const char* kDaemon = "stickslipd";
constexpr const char* kConfig = "stickslipd.toml";

constexpr const char* kManHelp = R"(Examples:
  stickslip man | man -l -
  stickslip man stickslipd.toml > stickslipd.toml.5)";

constexpr const char* kCompletionHelp = R"(Examples:
  source <(stickslip completion bash)
  stickslip completion bash > /etc/bash_completion.d/stickslip
  stickslip completion zsh > "${fpath[1]}/_stickslip"
  stickslip completion fish > ~/.config/fish/completions/stickslip.fish)";

/// The parser of stickslipd as that program has it.
struct DaemonParser {
  CLI::App app{daemon::kDaemonPurpose, kDaemon};
  daemon::DaemonOptions options;
  DaemonParser() {
    daemon::declare_daemon_options(app, options);
    app.set_version_flag("--version", base::kVersion);
  }
};

std::string page(const CLI::App& app, const std::string& name) {
  const std::string version = fmt::format("stickslip {}", base::kVersion);
  if (name == kTool) {
    return manual::command_page(
        app,
        {name, 1, version,
         "0 done, 1 the world did not allow it, 2 wrong usage or input, 130 interrupted. \\fBverify\\fR and "
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

std::string script(const CLI::App& app, const std::string& shell, const std::string& program) {
  if (shell == "bash") return manual::bash_completion(app, program);
  return shell == "zsh" ? manual::zsh_completion(app, program) : manual::fish_completion(app, program);
}

struct ManualOptions {
  std::string name = kTool;
  std::string shell;
};

}  // namespace

void add_manual(CLI::App& app, Chosen& chosen) {
  const auto kept = std::make_shared<ManualOptions>();
  CLI::App* man = app.add_subcommand("man", "a manual page, for man -l");
  man->footer(kManHelp);
  man->add_option("page", kept->name, "stickslip, stickslipd or stickslipd.toml")
      ->capture_default_str()
      ->check(CLI::IsMember({kTool, kDaemon, kConfig}))
      ->type_name("PAGE");
  choose(*man, chosen, [kept, &app]() -> base::Result<std::string> { return page(app, kept->name); });

  const auto asked = std::make_shared<ManualOptions>();
  CLI::App* completion = app.add_subcommand("completion", "completion of commands and options, for a shell");
  completion->footer(kCompletionHelp);
  completion->add_option("shell", asked->shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}))
      ->type_name("SHELL");
  completion->add_option("--program", asked->name, "stickslip or stickslipd")
      ->capture_default_str()
      ->check(CLI::IsMember({kTool, kDaemon}))
      ->type_name("NAME");
  choose(*completion, chosen, [asked, &app]() -> base::Result<std::string> {
    const DaemonParser daemon;
    return script(asked->name == kTool ? app : daemon.app, asked->shell, asked->name);
  });
}

}  // namespace stickslip::cli
