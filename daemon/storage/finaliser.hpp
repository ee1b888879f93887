/// \file
/// Runs the finaliser of a journal in a process of its own: HDF5's errors can end a process, and
/// the measurement must not be in it.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/dated_folders.hpp"

#include "core/base/result.hpp"
#include "core/record/finaliser.hpp"

namespace stickslip::storage {

using record::record_of;
using ExpectedScans = std::optional<std::int64_t>;  ///< Nothing if nobody knows.

/// Runs `program --finalise journal --scans expected` to its end, outside the terminal's process group so
/// that Ctrl-C does not reach it. Errors: kFailure naming the journal and how the process ended; the process
/// itself has written the reason to stderr.
[[nodiscard]] base::Result<record::Finalised> run_finaliser(const std::filesystem::path& program,
                                                            const std::filesystem::path& journal,
                                                            ExpectedScans expected);

/// What a process that finalises says of what it made, and the same read again. Errors: kFailure.
[[nodiscard]] std::string to_text(const record::Finalised& made);
[[nodiscard]] base::Result<record::Finalised> finalised_from_text(const std::filesystem::path& journal,
                                                                  const std::string& text);

/// What is missing of a record that was made, in words; empty if nothing is.
[[nodiscard]] std::string loss_of(const record::Finalised& made, ExpectedScans expected = {});

/// A finaliser whose daemon was killed goes on by itself; an hour of scans takes it 0.2 s. Others wait so
/// long.
inline constexpr std::chrono::seconds kOthersTime{10};

/// Somebody else has made the record in the meantime. A path that cannot be looked at is not known to be
/// finished.
[[nodiscard]] bool is_finished(const std::filesystem::path& journal);

/// What that process does: record::finalise(), with results for a test that was interrupted or damaged. It is
/// done as well if somebody else did it.
[[nodiscard]] base::Result<record::Finalised> finalise_here(const std::filesystem::path& journal,
                                                            ExpectedScans expected = {});

/// Journals that wait for their records: in the folder and in those of years, months and days below it.
[[nodiscard]] io::FilesFound journals_in(const std::filesystem::path& folder);

}  // namespace stickslip::storage
