#include "daemon/cli/scene_library.hpp"

#include <algorithm>
#include <functional>
#include <set>
#include <system_error>

#include "core/base/wording.hpp"

namespace stickslip::daemon {
namespace {

constexpr const char* kSceneExtension = ".toml";

bool is_folder(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored);
}

}  // namespace

base::Result<std::filesystem::path> scene_folder(const std::string& given) {
  if (!given.empty()) {
    if (!is_folder(given)) return base::usage_error("--folder {}: is no folder", base::one_line(given, 200));
    return std::filesystem::path{given};
  }
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path bin = program.parent_path();
  if (auto shared = bin.parent_path() / "share" / "stickslip" / "scenes"; is_folder(shared)) return shared;
  for (std::filesystem::path above = bin; above != above.root_path(); above = above.parent_path()) {
    if (auto source = above / "config" / "scenes"; is_folder(source)) return source;
  }
  return base::usage_error("no scenes were found beside the program; name their folder with --folder");
}

std::vector<std::filesystem::path> scenes_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> scenes;
  std::error_code error;
  for (auto entry = std::filesystem::directory_iterator(folder, error);
       !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    if (entry->path().extension() == kSceneExtension) scenes.push_back(entry->path());
  }
  std::sort(scenes.begin(), scenes.end());
  return scenes;
}

base::Result<std::filesystem::path> find_scene(const std::string& scene, const std::string& given) {
  std::error_code ignored;
  const std::filesystem::path file{scene};
  // A folder is let through: reading it says what is wrong.
  if (std::filesystem::exists(file, ignored) || file.has_parent_path() ||
      file.extension() == kSceneExtension) {
    return file;
  }
  const base::Result<std::filesystem::path> folder = scene_folder(given);
  if (!folder) return tl::unexpected(folder.error());
  std::set<std::string, std::less<>> names;
  for (const std::filesystem::path& known : scenes_in(*folder)) {
    if (known.stem() == scene) return known;
    names.insert(known.stem().string());
  }
  return base::usage_error("{}: is neither a file nor a scene in {}; {}", base::one_line(scene),
                           folder->string(), base::spelling_hint(scene, names));
}

}  // namespace stickslip::daemon
