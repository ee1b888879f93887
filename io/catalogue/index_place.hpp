/// \file
/// Where the index of a folder of records is kept.
#pragma once

#include <filesystem>

#include "core/base/result.hpp"

namespace stickslip::catalogue {

/// `stickslip/catalogue-HASH.sqlite` in $XDG_CACHE_HOME, else in $HOME/.cache, with the folder made for this
/// user alone. Never in the folder of records: who may write there could make SQLite, in the programs of all
/// who read there, open what it was not made for. \param folder  canonical. Errors: kFailure if there is no
/// place, or it cannot be written.
[[nodiscard]] base::Result<std::filesystem::path> index_place(const std::filesystem::path& folder);

}  // namespace stickslip::catalogue
