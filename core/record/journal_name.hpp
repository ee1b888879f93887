/// \file
/// Names of journals and of the records that are made of them.
#pragma once

#include <filesystem>

namespace stickslip::record {

/// `wanted`, a journal; or, while a journal or a record of that name stands there, or it is `taken`, with a
/// number: NAME-2, NAME-3 …
[[nodiscard]] std::filesystem::path free_journal_path(const std::filesystem::path& wanted,
                                                      const std::filesystem::path& taken = {});

}  // namespace stickslip::record
