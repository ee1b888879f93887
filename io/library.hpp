/// \file
/// Folders of TOML files that come with the program, and whose files have names.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"

namespace stickslip::io {

struct Library {
  std::string_view folder;  ///< In share/stickslip/ and config/: "scenes".
  std::string_view noun;    ///< Of one file: "scene".
};

inline constexpr Library kScenes{"scenes", "scene"};
inline constexpr Library kMethods{"methods", "method"};

/// The folder given; else share/stickslip/ beside the program's bin/, else config/ in a folder above the
/// program, as after a build. Usage error: there is none.
[[nodiscard]] base::Result<std::filesystem::path> library_folder(const Library& library,
                                                                 const std::string& given);

/// The TOML files of a folder, sorted.
[[nodiscard]] std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder);

/// A file by its path or a file of the library by its name. Usage error: neither.
/// \param given  as for library_folder().
[[nodiscard]] base::Result<std::filesystem::path> find_in(const Library& library, const std::string& name,
                                                          const std::string& given);

}  // namespace stickslip::io
