#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <memory>
#include <string>

#include "cli/ask.hpp"
#include "cli/subcommands.hpp"
#include <nlohmann/json.hpp>

#include "core/base/regular_file.hpp"

namespace stickslip::cli {
namespace {

struct PageOptions : BenchOptions {
  bool print = false;
};

constexpr const char* kPageExamples =
    R"(Examples:
  stickslip page
  stickslip page --print                                  for a browser on another computer
  stickslip page --socket /run/stickslip/control.sock)";

/// Starts the browser of a desktop, which outlives this command and has nothing of its terminal. \return
/// whether there is one.
bool open_browser(const std::string& address) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return false;
  std::string program = "xdg-open";
  std::string argument = address;
  const std::array<char*, 3> words{program.data(), argument.data(), nullptr};
  posix_spawn_file_actions_t actions{};
  ::posix_spawn_file_actions_init(&actions);
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    ::posix_spawn_file_actions_addopen(&actions, descriptor, "/dev/null", O_RDWR, 0);
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, program.c_str(), &actions, nullptr, words.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  return error == 0;
}

base::Result<std::string> run_page(const PageOptions& options) {
  const base::Result<nlohmann::ordered_json> status = ask(options, {"GET", "/v1/status", {}, {}, {}});
  if (!status) return tl::unexpected(status.error());
  const auto page = status->find("page");
  if (page == status->end() || !page->is_object()) {
    return base::usage_error(
        "the daemon serves no page: set http = \"127.0.0.1:8037\" in [control] of its configuration, and "
        "restart it");
  }
  const std::string file = page->value("token_file", "");
  const base::Result<std::string> token = base::read_text(file);
  if (!token) {
    return base::failure(
        "{}; it may be read by root and by the group that runs the daemon: try sudo stickslip page",
        token.error().message);
  }
  const std::string address = fmt::format("{}#token={}", page->value("address", ""),
                                          token->substr(0, token->find_last_not_of(" \n") + 1));
  if (!options.print && open_browser(address)) return "the page opens in the browser\n";
  return address + "\n";
}

}  // namespace

void add_page(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<PageOptions>();
  CLI::App* command =
      app.add_subcommand("page", "open the daemon's live page; without a desktop, print its address");
  command->add_option("--socket", options->socket, "the daemon's control socket")
      ->capture_default_str()
      ->type_name("PATH");
  command->add_flag("--print", options->print,
                    "print the address, with the token that lets whoever has it use the bench");
  command->footer(kPageExamples);
  choose(*command, chosen, [options] { return run_page(*options); });
}

}  // namespace stickslip::cli
