/// \file
/// Where records stand.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace stickslip::io {

/// In which folders below the one of the records a file stands, by the date of its start, UTC.
enum class DatedFolders {
  kNone,
  kMonth,  ///< 2026/11
  kDay,    ///< 2026-11-21
};

/// Folders below the one of the records in which records stand: years and months, or days.
inline constexpr int kDeepestRecordFolder = 2;

/// A folder that cannot be looked into.
struct UnreadFolder {
  std::filesystem::path folder;
  std::string why;
};

struct FilesFound {
  std::vector<std::filesystem::path> files;  ///< Sorted.
  std::vector<UnreadFolder> unread;          ///< There may be more files in these.
};

/// Files in the folder of the records and in those of years, months and days below it. What is no longer
/// there is no error; symbolic links to folders are not followed.
[[nodiscard]] FilesFound find_files(const std::filesystem::path& folder,
                                    const std::function<bool(const std::filesystem::path&)>& wanted);

}  // namespace stickslip::io
