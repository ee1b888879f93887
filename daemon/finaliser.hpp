/// \file
/// Runs the finaliser of a journal in a process of its own: HDF5's errors can end a process, and
/// the measurement must not be in it.
#pragma once

#include <chrono>
#include <filesystem>
#include <vector>

#include "core/base/result.hpp"

namespace stickslip::daemon {

/// The finished file of a journal: beside it, with the extension .h5.
[[nodiscard]] std::filesystem::path record_of(const std::filesystem::path& journal);

/// Runs `program --finalise journal` to its end, outside the terminal's process group so that
/// Ctrl-C does not reach it.
/// \return the finished file. Errors: kFailure naming the journal and how the process ended; the
///         process itself has written the reason to stderr.
[[nodiscard]] base::Result<std::filesystem::path> run_finaliser(const std::filesystem::path& program,
                                                                const std::filesystem::path& journal);

/// A finaliser whose daemon was killed goes on by itself; an hour of scans takes it 0.2 s. Others wait so
/// long.
inline constexpr std::chrono::seconds kOthersTime{10};

/// Somebody else has made the record in the meantime.
[[nodiscard]] bool is_finished(const std::filesystem::path& journal);

/// What that process does: record::finalise(), with results for a test that was interrupted. It is done as
/// well if somebody else did it.
[[nodiscard]] base::Result<std::filesystem::path> finalise_here(const std::filesystem::path& journal);

/// Journals in the folder and in those of years and months below it, sorted; none if it cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> journals_in(const std::filesystem::path& folder);

}  // namespace stickslip::daemon
