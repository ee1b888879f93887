/// \file
/// Builds the record of a journal in a child process, because errors of HDF5 can end a process and the daemon
/// must go on measuring.
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
/// Scans that were written to a journal; absent: unknown.
using ExpectedScans = std::optional<std::int64_t>;

/// Runs `program --finalise journal --scans expected`; blocks until it ends. The child has its own process
/// group, so that Ctrl-C does not reach it. Errors: kFailure with the journal and how the child ended; the
/// child writes the reason to stderr.
[[nodiscard]] base::Result<record::Finalised> run_finaliser(const std::filesystem::path& program,
                                                            const std::filesystem::path& journal,
                                                            ExpectedScans expected);

/// Writes and reads the line by which the child reports its result on stdout. Errors: kFailure if the text is
/// no such line.
[[nodiscard]] std::string to_text(const record::Finalised& made);
[[nodiscard]] base::Result<record::Finalised> finalised_from_text(const std::filesystem::path& journal,
                                                                  const std::string& text);

/// Describes, for people, what a record lacks of its journal; empty if it is complete. \param expected  scans
/// written to the journal.
[[nodiscard]] std::string loss_of(const record::Finalised& made, ExpectedScans expected = {});

/// Longest wait for another process that holds the journal, such as a finaliser that outlived its killed
/// daemon. A finaliser needs 0.2 s for an hour of scans.
inline constexpr std::chrono::seconds kOthersTime{10};

/// True if the record exists and its journal is gone: another process has finalised it. False too if a path
/// cannot be examined.
[[nodiscard]] bool is_finished(const std::filesystem::path& journal);

/// Finalises a journal in this process; `--finalise` calls it. An interrupted or damaged test is analysed
/// first, so that its record has results. It succeeds also if another process has made the record meanwhile.
/// Waits for a locked journal up to kOthersTime. Errors: as record::finalise().
[[nodiscard]] base::Result<record::Finalised> finalise_here(const std::filesystem::path& journal,
                                                            ExpectedScans expected = {});

/// Finds all journals in the record folder and its dated subfolders.
[[nodiscard]] io::FilesFound journals_in(const std::filesystem::path& folder);

}  // namespace stickslip::storage
