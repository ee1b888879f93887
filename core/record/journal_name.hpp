/// \file
/// Choice of journal names.
#pragma once

#include <filesystem>

namespace stickslip::record {

/// A free journal path, where nothing is created: `wanted`, or NAME-2, NAME-3 … if a journal or a record of
/// that name exists or the path is `taken`.
[[nodiscard]] std::filesystem::path free_journal_path(const std::filesystem::path& wanted,
                                                      const std::filesystem::path& taken = {});

}  // namespace stickslip::record
