/// \file
/// Recovery: makes records of journals that an earlier program left behind. The daemon does it at its start,
/// `stickslip recover` on request.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

#include "core/base/result.hpp"
#include "core/record/finaliser.hpp"
#include "daemon/types/event_receiver.hpp"

namespace stickslip::storage {

/// Builds the record of a journal. \param expected  scans written to the journal; absent: unknown.
using Finalise = std::function<base::Result<record::Finalised>(const std::filesystem::path& journal,
                                                               std::optional<std::int64_t> expected)>;

/// Outcome of a recovery, from best to worst.
enum class Recovery {
  kDone,     ///< Every journal is a complete record, or held no scan.
  kDamaged,  ///< Every journal is a record, but some were unreadable in part; those journals stay.
  kRefused,  ///< Some journals are no records, or a folder cannot be listed.
};

/// Recovers every journal in the record folder and its dated subfolders, in the order of their paths; blocks.
/// A journal that another process writes is left alone; one with an incomplete header holds nothing and is
/// removed; all others are finalised. A failure is reported to `events`, the journal is kept, and recovery
/// goes on. \return the worst outcome.
[[nodiscard]] Recovery recover_folder(const std::filesystem::path& folder, const Finalise& finalise,
                                      daemon::EventReceiver& events);

/// Recovers one journal.
[[nodiscard]] Recovery recover_journal(const std::filesystem::path& journal, const Finalise& finalise,
                                       daemon::EventReceiver& events);

}  // namespace stickslip::storage
