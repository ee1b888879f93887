/// \file
/// Shipped libraries of TOML files (scenes, test methods). A user names a file by its stem or by a path.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"

namespace stickslip::io {

struct Library {
  std::string_view folder;  ///< Its name in share/stickslip/ and config/: "scenes".
  std::string_view noun;    ///< What one file is, for messages: "scene".
};

inline constexpr Library kScenes{"scenes", "scene"};
inline constexpr Library kMethods{"methods", "method"};

/// The library's folder: `given` unless it is empty, else in share/stickslip/ beside the program's bin/, else
/// in config/ of a folder above the program (after a build). Errors: kUsage if none exists.
[[nodiscard]] base::Result<std::filesystem::path> library_folder(const Library& library,
                                                                 const std::string& given);

/// The TOML files of a folder, sorted.
[[nodiscard]] std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder);

/// Finds a file. `name` is a path if such a file exists, it has a folder part or it ends in .toml; else it is
/// the name of a file of the library. Errors: kUsage if the library has no such file. \param given  as for
/// library_folder().
[[nodiscard]] base::Result<std::filesystem::path> find_in(const Library& library, const std::string& name,
                                                          const std::string& given);

}  // namespace stickslip::io
