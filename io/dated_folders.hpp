/// \file
/// Folders of records by date, and the search for files in them.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace stickslip::io {

/// How records are sorted into subfolders of the record folder, by the UTC date at which the test began.
enum class DatedFolders {
  kNone,
  kMonth,  ///< 2026/11
  kDay,    ///< 2026-11-21
};

/// Depth of the deepest subfolder that holds records: 2 for kMonth (year/month).
inline constexpr int kDeepestRecordFolder = 2;

/// A folder that cannot be listed.
struct UnreadFolder {
  std::filesystem::path folder;
  std::string why;
};

struct FilesFound {
  std::vector<std::string> files;    ///< Paths, sorted by their bytes.
  std::vector<UnreadFolder> unread;  ///< These may hold more files.
};

/// Finds files in a folder and in its subfolders, `deepest` levels down. A folder that does not
/// exist counts as empty. \param wanted  whether a file of this name is listed. Symbolic links to folders are
/// not followed, and `lost+found` is skipped.
[[nodiscard]] FilesFound find_files(const std::filesystem::path& folder,
                                    const std::function<bool(std::string_view name)>& wanted,
                                    int deepest = kDeepestRecordFolder);

}  // namespace stickslip::io
