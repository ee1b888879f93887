/// \file
/// Journals that a stop left behind become records: what the daemon does first, and `stickslip recover` by
/// hand.
#pragma once

#include <filesystem>
#include <functional>

#include "core/base/result.hpp"
#include "daemon/facts.hpp"

namespace stickslip::daemon {

/// Builds the finished file of a journal.
using Finalise = std::function<base::Result<std::filesystem::path>(const std::filesystem::path& journal)>;

/// Every journal in the folder and in those of the years and months below it, by name. One that somebody
/// writes is left alone; one that a stop left before its header was whole holds nothing and is removed; all
/// others are finalised. What cannot be is told and kept: the rest is done nevertheless. \return whether all
/// was done.
[[nodiscard]] bool recover_folder(const std::filesystem::path& folder, const Finalise& finalise,
                                  Facts& facts);

/// The same for one journal.
[[nodiscard]] bool recover_journal(const std::filesystem::path& journal, const Finalise& finalise,
                                   Facts& facts);

}  // namespace stickslip::daemon
