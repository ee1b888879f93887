#include "io/library.hpp"

#include <algorithm>
#include <functional>
#include <set>
#include <system_error>

#include "core/base/wording.hpp"

namespace stickslip::io {
namespace {

constexpr const char* kExtension = ".toml";

bool is_folder(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored);
}

}  // namespace

base::Result<std::filesystem::path> library_folder(const Library& library, const std::string& given) {
  if (!given.empty()) {
    if (!is_folder(given)) return base::usage_error("--folder {}: is no folder", base::one_line(given, 200));
    return std::filesystem::path{given};
  }
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path bin = program.parent_path();
  if (auto shared = bin.parent_path() / "share" / "stickslip" / library.folder; is_folder(shared))
    return shared;
  for (std::filesystem::path above = bin; above != above.root_path(); above = above.parent_path()) {
    if (auto source = above / "config" / library.folder; is_folder(source)) return source;
  }
  return base::usage_error("no {} were found beside the program; name their folder with --folder",
                           library.folder);
}

std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (auto entry = std::filesystem::directory_iterator(folder, error);
       !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    if (entry->path().extension() == kExtension) files.push_back(entry->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

base::Result<std::filesystem::path> find_in(const Library& library, const std::string& name,
                                            const std::string& given) {
  std::error_code ignored;
  const std::filesystem::path file{name};
  // A folder is let through: reading it says what is wrong.
  if (std::filesystem::exists(file, ignored) || file.has_parent_path() || file.extension() == kExtension) {
    return file;
  }
  const base::Result<std::filesystem::path> folder = library_folder(library, given);
  if (!folder) return tl::unexpected(folder.error());
  std::set<std::string, std::less<>> names;
  for (const std::filesystem::path& known : files_in(*folder)) {
    if (known.stem() == name) return known;
    names.insert(known.stem().string());
  }
  return base::usage_error("{}: is neither a file nor a {} in {}; {}", base::one_line(name), library.noun,
                           folder->string(), base::spelling_hint(name, names));
}

}  // namespace stickslip::io
