#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/subcommands.hpp"
#include "io/json_text.hpp"
#include "io/library.hpp"
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
  std::vector<sim::Scene> scenes;
  std::size_t longest = 0;
  for (const std::filesystem::path& file : io::files_in(*found)) {
    base::Result<sim::Scene> scene = sim::load_scene(file);
    if (!scene) return tl::unexpected(scene.error());
    longest = std::max(longest, scene->name.size());
    scenes.push_back(std::move(*scene));
  }
  if (options.json) {
    using Json = nlohmann::ordered_json;
    Json list = Json::array();
    for (const sim::Scene& scene : scenes) {
      list.push_back({{"name", scene.name}, {"description", scene.description}});
    }
    return io::json_document(Json{{"folder", found->string()}, {"scenes", std::move(list)}});
  }
  std::string text;
  for (const sim::Scene& scene : scenes)
    text += fmt::format("{:<{}}  {}\n", scene.name, longest, scene.description);
  return text;
}

}  // namespace

void add_scenes(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<ScenesOptions>();
  CLI::App* command = app.add_subcommand("scenes", "list the shipped scenes");
  command->add_option("--folder", options->folder, "another folder of scenes")->type_name("DIR");
  command->add_flag("--json", options->json, "JSON instead of lines");
  choose(*command, chosen, [options] { return run_scenes(*options); });
}

}  // namespace stickslip::cli
