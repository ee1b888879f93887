/// \file
/// Searches the records of a folder tree. An index of them is kept between searches and follows the files
/// before each: only new and changed ones are read.
///
///     const Result<Found> found = search("/var/lib/stickslip/records", query, {});
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "io/catalogue/index.hpp"
#include "io/dated_folders.hpp"

#include "core/base/result.hpp"

namespace stickslip::catalogue {

/// What following the files came to.
struct Followed {
  std::size_t file_count = 0;
  std::size_t read_count = 0;     ///< New, changed, or refused before.
  std::size_t removed_count = 0;  ///< In the index, and no longer there.
};

struct Found {
  std::vector<Entry> entries;
  std::size_t match_count = 0;  ///< Records that meet the conditions: entries, and those beyond Query::most.
  std::vector<UnreadFile> unread;                ///< Of the whole tree, whatever the conditions are.
  std::vector<io::UnreadFolder> unread_folders;  ///< Their records are missing here.
  Followed followed;
  std::vector<std::string> notices;  ///< One line each: why the index was made anew, or cannot be kept.
};

/// \param done,count  of the files that are read, before each of them.
using Progress = std::function<void(std::size_t done, std::size_t count)>;

/// Without a place for the index, none is kept. Errors: kUsage if the folder does not exist or is none;
/// kNoPermission if it cannot be listed; kBusy if another process goes on writing the index; kFailure if it
/// cannot be used.
[[nodiscard]] base::Result<Found> search(const std::filesystem::path& folder, const Query& query,
                                         const Progress& progress);

/// The same with a file for the index. \param index  empty: none is kept.
[[nodiscard]] base::Result<Found> search_with(const std::filesystem::path& index,
                                              const std::filesystem::path& folder, const Query& query,
                                              const Progress& progress);

}  // namespace stickslip::catalogue
