// Subcommands that say what there is: scenes, methods, boards, status.

#include <fmt/format.h>

#include <cstdio>
#include <vector>

#include "cli/commands.hpp"
#include "cli/subcommands.hpp"
#include "io/print_text.hpp"

namespace stickslip::cli {
namespace {

/// A list from a folder.
struct ListOptions {
  std::string folder;
  bool json = false;
};

void add_scenes(CLI::App& app, Chosen& chosen) {
  const auto kept = std::make_shared<ListOptions>();
  CLI::App* scenes = app.add_subcommand("scenes", "list the shipped scenes");
  scenes->add_option("--folder", kept->folder, "another folder of scenes")->type_name("DIR");
  scenes->add_flag("--json", kept->json, "JSON instead of lines");
  choose(*scenes, chosen, [kept] { return run_scenes(kept->folder, kept->json); });
}

void add_methods(CLI::App& app, Chosen& chosen) {
  const auto kept = std::make_shared<ListOptions>();
  CLI::App* methods = app.add_subcommand("methods", "list the shipped test methods");
  methods->add_option("--folder", kept->folder, "another folder of methods")->type_name("DIR");
  methods->add_flag("--json", kept->json, "JSON instead of lines, with all settings and what to check");
  choose(*methods, chosen, [kept] { return run_methods(kept->folder, kept->json); });
}

struct BoardsOptions {
  std::vector<std::string> devices;
  bool json = false;
};

void add_boards(CLI::App& app, Chosen& chosen) {
  const auto kept = std::make_shared<BoardsOptions>();
  CLI::App* boards = app.add_subcommand(
      "boards",
      "list the boards under Linux Comedi and what a configuration should say; 1 if none can be used");
  boards->add_option("devices", kept->devices, "only these; else all of /dev/comedi*")->type_name("DEVICE");
  boards->add_flag("--json", kept->json, "JSON instead of text");
  boards->callback([&chosen, kept] {
    chosen.run = [kept] {
      const BoardsOutput output = run_boards(kept->devices, kept->json);
      io::print_text(stdout, output.text);
      return output.any_usable && std::fflush(stdout) == 0 ? 0 : 1;
    };
  });
}

void add_status(CLI::App& app, Chosen& chosen) {
  const auto socket = std::make_shared<std::string>("/run/stickslip/control.sock");
  const auto json = std::make_shared<bool>(false);
  CLI::App* status = app.add_subcommand("status", "ask the running daemon");
  status->add_option("--socket", *socket, "its control socket")->capture_default_str()->type_name("PATH");
  status->add_flag("--json", *json, "JSON as GET /v1/status gives it, instead of text");
  choose(*status, chosen, [socket, json] { return run_status(*socket, *json); });
}

}  // namespace

void add_asking_commands(CLI::App& app, Chosen& chosen) {
  add_scenes(app, chosen);
  add_boards(app, chosen);
  add_methods(app, chosen);
  add_status(app, chosen);
}

}  // namespace stickslip::cli
