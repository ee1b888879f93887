#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "cli/commands.hpp"
#include "cli/scene_library.hpp"
#include "io/json_text.hpp"
#include <nlohmann/json.hpp>

#include "core/sim/scene.hpp"

namespace stickslip::cli {

base::Result<std::string> run_scenes(const std::string& folder, bool json) {
  const base::Result<std::filesystem::path> found = scene_folder(folder);
  if (!found) return tl::unexpected(found.error());
  std::vector<sim::Scene> scenes;
  std::size_t longest = 0;
  for (const std::filesystem::path& file : scenes_in(*found)) {
    base::Result<sim::Scene> scene = sim::load_scene(file);
    if (!scene) return tl::unexpected(scene.error());
    longest = std::max(longest, scene->name.size());
    scenes.push_back(std::move(*scene));
  }
  if (json) {
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

}  // namespace stickslip::cli
