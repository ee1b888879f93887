#include "cli/subcommands.hpp"

#include <cstdio>

#include "cli/paint.hpp"
#include "io/print_text.hpp"

namespace stickslip::cli {

int print(const base::Result<std::string>& output) {
  if (!output) {
    io::print_error("stickslip", output.error().message);
    return output.error().exit_status();
  }
  io::print_text(stdout, *output, wants_colours());
  return std::fflush(stdout) == 0 ? 0 : 1;
}

void choose(CLI::App& command, Chosen& chosen, std::function<base::Result<std::string>()> run) {
  command.callback([&chosen, run = std::move(run)] { chosen.run = [run] { return print(run()); }; });
}

void add_method_option(CLI::App& command, std::string& method) {
  command
      .add_option("--method", method,
                  "test method by which the traditional coefficients are read: file.toml, or name as in "
                  "stickslip methods")
      ->type_name("METHOD");
}

/// Scene and changes.
void add_scene_options(CLI::App& command, SceneOptions& options) {
  command.add_option("scene", options.scene, "file, or name as in stickslip scenes")
      ->required()
      ->type_name("SCENE");
  command.add_option("--seed", options.seed, "of the random numbers; else that of the scene")->type_name("N");
  command.add_option("--set", options.set, "change a key of the scene; may be repeated")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  command.add_option("--without", options.without, "drop a listed effect; may be repeated")
      ->allow_extra_args(false)
      ->type_name("EFFECT");
  command
      .add_option("--duration", options.duration, "of the whole scene, s or with unit: the pull is fitted")
      ->type_name("T");
  command.add_option("--rate", options.rate, "scans per second; else that of the scene")->type_name("HZ");
  command.add_option("--folder", options.folder, "of the scenes that have names")->type_name("DIR");
}

}  // namespace stickslip::cli
