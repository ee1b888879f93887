#include <memory>
#include <string>

#include "cli/subcommands.hpp"
#include "io/json_text.hpp"
#include "io/library.hpp"
#include "io/table.hpp"
#include <nlohmann/json.hpp>

#include "core/sim/scene.hpp"

namespace stickslip::cli {
namespace {

struct ScenesOptions {
  std::string folder;  ///< Empty: where the program finds them.
  bool json = false;
};

base::Result<std::string> run_scenes(const ScenesOptions& options) {
  const base::Result<std::filesystem::path> found = io::library_folder(io::kScenes, options.folder);
  if (!found) return tl::unexpected(found.error());
  using enum io::Table::Align;
  io::Table scenes{{{.name = "name", .heading = "", .align = kLeft},
                    {.name = "description", .heading = "", .align = kLeft}}};
  for (const std::filesystem::path& file : io::files_in(*found)) {
    const base::Result<sim::Scene> scene = sim::load_scene(file);
    if (!scene) return tl::unexpected(scene.error());
    scenes.add({scene->name, scene->description});
  }
  if (!options.json) return scenes.text();
  return io::json_document({{"folder", found->string()}, {"scenes", scenes.json()}});
}

constexpr const char* kScenesExamples =
    R"(Examples:
  stickslip scenes
  stickslip scenes --json
  stickslip scenes --folder my-scenes)";

}  // namespace

void add_scenes(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<ScenesOptions>();
  CLI::App* command = app.add_subcommand("scenes", "list the shipped scenes");
  command->footer(kScenesExamples);
  command->add_option("--folder", options->folder, "another folder of scenes")->type_name("DIR");
  command->add_flag("--json", options->json, "JSON instead of lines");
  choose(*command, chosen, [options] { return run_scenes(*options); });
}

}  // namespace stickslip::cli
