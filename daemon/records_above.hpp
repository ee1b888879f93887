/// \file
/// The records of the daemon, by the time in their names.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace stickslip::daemon {

/// Records of the daemon in the folder and in those of years and months below it whose name is above
/// `newest`; the latest `most` of them, oldest first.
[[nodiscard]] std::vector<std::filesystem::path> records_above(const std::filesystem::path& folder,
                                                               const std::string& newest, std::size_t most);

}  // namespace stickslip::daemon
