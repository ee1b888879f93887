#include "daemon/cli/scene_library.hpp"

#include "daemon/library.hpp"

namespace stickslip::daemon {

base::Result<std::filesystem::path> scene_folder(const std::string& given) {
  return library_folder(kScenes, given);
}

std::vector<std::filesystem::path> scenes_in(const std::filesystem::path& folder) { return files_in(folder); }

base::Result<std::filesystem::path> find_scene(const std::string& scene, const std::string& given) {
  return find_in(kScenes, scene, given);
}

}  // namespace stickslip::daemon
