#include "io/dated_folders.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <string_view>

#include "core/base/wording.hpp"

namespace stickslip::io {
namespace {

struct CloseListing {
  void operator()(DIR* listing) const noexcept { ::closedir(listing); }
};

/// No link to a folder counts as one.
bool is_folder(DIR& listing, const dirent& entry) {
  // Most listings tell it: no further call for each of thousands of files.
  if (entry.d_type != DT_UNKNOWN) return entry.d_type == DT_DIR;
  struct stat found {};
  return ::fstatat(::dirfd(&listing), entry.d_name, &found, AT_SYMLINK_NOFOLLOW) == 0 &&
         S_ISDIR(found.st_mode);
}

// std::filesystem splits the path of each entry into its parts, which takes longer than the listing.
void look_into(const std::string& folder, int deeper, const std::function<bool(std::string_view)>& wanted,
               FilesFound& found) {
  const std::unique_ptr<DIR, CloseListing> listing{::opendir(folder.c_str())};
  const std::string prefix = folder.ends_with('/') ? folder : folder + '/';
  const auto next = [&listing] {
    errno = 0;  // Else the end of the listing is not told from an error.
    return ::readdir(listing.get());
  };
  const dirent* entry = nullptr;
  while (listing && (entry = next()) != nullptr) {
    const std::string_view name = entry->d_name;
    if (name == "." || name == "..") continue;
    if (!is_folder(*listing, *entry)) {
      if (wanted(name)) found.files.push_back((prefix + std::string{name}));
    } else if (deeper > 0 && name != "lost+found") {  // The kernel's: only root may look into it.
      look_into(prefix + std::string{name}, deeper - 1, wanted, found);
    }
  }
  if (errno != 0 && errno != ENOENT) found.unread.push_back({folder, base::system_message(errno)});
}

}  // namespace

FilesFound find_files(const std::filesystem::path& folder,
                      const std::function<bool(std::string_view name)>& wanted, int deepest) {
  FilesFound found;
  look_into(folder.native(), deepest, wanted, found);
  std::ranges::sort(found.files);
  return found;
}

}  // namespace stickslip::io
