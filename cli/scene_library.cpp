#include "cli/scene_library.hpp"

#include "io/library.hpp"

namespace stickslip::cli {

base::Result<std::filesystem::path> scene_folder(const std::string& given) {
  return io::library_folder(io::kScenes, given);
}

std::vector<std::filesystem::path> scenes_in(const std::filesystem::path& folder) {
  return io::files_in(folder);
}

base::Result<std::filesystem::path> find_scene(const std::string& scene, const std::string& given) {
  return io::find_in(io::kScenes, scene, given);
}

}  // namespace stickslip::cli
