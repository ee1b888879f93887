/// \file
/// The scenes that come with the program.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.hpp"

namespace stickslip::cli {

/// The folder given; else share/stickslip/scenes beside the program's bin/, else config/scenes in a
/// folder above the program, as after a build. Usage error: there is none.
[[nodiscard]] base::Result<std::filesystem::path> scene_folder(const std::string& given);

/// The scene files of a folder, sorted.
[[nodiscard]] std::vector<std::filesystem::path> scenes_in(const std::filesystem::path& folder);

/// A file by its path or a scene of the folder by its name. Usage error: neither.
/// \param given  as for scene_folder().
[[nodiscard]] base::Result<std::filesystem::path> find_scene(const std::string& scene,
                                                             const std::string& given);

}  // namespace stickslip::cli
