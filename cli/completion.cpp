#include "cli/manual/completion.hpp"

#include <memory>
#include <string>

#include "cli/daemon_parser.hpp"
#include "cli/subcommands.hpp"

namespace stickslip::cli {
namespace {

struct CompletionOptions {
  std::string program = kTool;
  std::string shell;
};

std::string script(const CLI::App& app, const std::string& shell, const std::string& program) {
  if (shell == "bash") return manual::bash_completion(app, program);
  return shell == "zsh" ? manual::zsh_completion(app, program) : manual::fish_completion(app, program);
}

constexpr const char* kCompletionHelp = R"(Examples:
  source <(stickslip completion bash)
  stickslip completion bash > /etc/bash_completion.d/stickslip
  stickslip completion zsh > "${fpath[1]}/_stickslip"
  stickslip completion fish > ~/.config/fish/completions/stickslip.fish)";

}  // namespace

void add_completion(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<CompletionOptions>();
  CLI::App* command =
      app.add_subcommand("completion", "print the completion of commands and options for a shell");
  command->footer(kCompletionHelp);
  command->add_option("shell", options->shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}))
      ->type_name("SHELL");
  command->add_option("--program", options->program, "stickslip or stickslipd")
      ->capture_default_str()
      ->check(CLI::IsMember({kTool, kDaemon}))
      ->type_name("NAME");
  choose(*command, chosen, [options, &app]() -> base::Result<std::string> {
    const DaemonParser daemon;
    return script(options->program == kTool ? app : daemon.app, options->shell, options->program);
  });
}

}  // namespace stickslip::cli
