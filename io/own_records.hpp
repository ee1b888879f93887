/// \file
/// Finds the records that a daemon made, by their file names.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

namespace stickslip::io {

/// The records named as by record_stem() in the record folder and its dated subfolders, sorted by name: by
/// the wall clock at the start of each test. Unreadable folders are skipped.
[[nodiscard]] std::vector<std::filesystem::path> own_records(const std::filesystem::path& folder);

/// Removes all but the last `most` elements.
void keep_last(std::vector<std::filesystem::path>& records, std::size_t most);

}  // namespace stickslip::io
