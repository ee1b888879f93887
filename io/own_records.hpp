/// \file
/// The records of the daemon, by their names.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

namespace stickslip::io {

/// Records of the daemon in the folder and in those of years and months below it, in the order of their
/// names: that of the clock of then. Folders that cannot be read are left out.
[[nodiscard]] std::vector<std::filesystem::path> own_records(const std::filesystem::path& folder);

/// Leaves the last `most` of them.
void keep_last(std::vector<std::filesystem::path>& records, std::size_t most);

}  // namespace stickslip::io
