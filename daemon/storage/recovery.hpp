/// \file
/// Journals that a stop left behind become records: what the daemon does first, and `stickslip recover` by
/// hand.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

#include "core/base/result.hpp"
#include "core/record/finaliser.hpp"
#include "daemon/types/facts.hpp"

namespace stickslip::storage {

/// Builds the finished file of a journal.
/// \param expected  scans that were written to the journal.
using Finalise = std::function<base::Result<record::Finalised>(const std::filesystem::path& journal,
                                                               std::optional<std::int64_t> expected)>;

/// What became of journals, the worst last.
enum class Recovery {
  kDone,     ///< Each is a whole record, or held nothing.
  kDamaged,  ///< Each is a record, but some could not be read whole and stay beside theirs.
  kRefused,  ///< Some are no record, or may stand in a folder that cannot be looked into.
};

/// Every journal in the folder and in those of the years and months below it, by name. One that somebody
/// writes is left alone; one that a stop left before its header was whole holds nothing and is removed; all
/// others are finalised. What cannot be is told and kept: the rest is done nevertheless. \return the
/// worst.
[[nodiscard]] Recovery recover_folder(const std::filesystem::path& folder, const Finalise& finalise,
                                      daemon::Facts& facts);

/// The same for one journal.
[[nodiscard]] Recovery recover_journal(const std::filesystem::path& journal, const Finalise& finalise,
                                       daemon::Facts& facts);

}  // namespace stickslip::storage
