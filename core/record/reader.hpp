/// \file
/// Reads finished records: everything that is needed to repeat the analysis.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "core/base/result.hpp"
#include "core/record/file_calls.hpp"
#include "core/record/record.hpp"
#include "core/record/scan_source.hpp"

namespace stickslip::record {

/// Reads a record. Objects that can be computed from the raw values (results, cycles, flags), gaps and events
/// may be missing from a reduced file, and are then absent from the record.
/// \return the record with `end` and `sha256` set. Errors are one line that names the file and what is wrong:
/// kUsage if it is not an HDF5 file, not a record, of another version, truncated, damaged or has data of
/// other types or shapes; kBusy, kNoPermission or kFailure if it cannot be opened, as open_shared().
[[nodiscard]] base::Result<Record> read_record(const std::filesystem::path& path,
                                               const FileCalls& calls = system_calls());

/// Reads a record whose scans (with what stands beside them: second channel, spikes, noise-free force), gaps,
/// events, and cycles and modes of the truth stay empty. The raw values are compared with their checksum.
/// Errors as read_record(), but damage in what is not read is not found.
/// \param only  names of the results to read, the others are absent; empty: all.
[[nodiscard]] base::Result<Record> read_without_scans(const std::filesystem::path& path,
                                                      std::span<const std::string> only = {},
                                                      const FileCalls& calls = system_calls());

/// Reads a record without its columns: scans, cycles, gaps, events and truth stay empty. The raw values are
/// not looked at, so neither is their checksum. Errors as read_record().
[[nodiscard]] base::Result<Record> read_facts(const std::filesystem::path& path,
                                              const FileCalls& calls = system_calls());

/// Verifies a file against the record and source it was written from, piece by piece. Errors: kUsage if the
/// file is invalid or its scans (index, raw value, code of the second channel, noise-free force where both
/// have it) differ from the source in any bit;
/// kFailure if it cannot be read. Of `record` only the board is compared.
[[nodiscard]] base::Result<void> verify_record(const std::filesystem::path& path, const Record& record,
                                               const ScanSource& scans,
                                               const FileCalls& calls = system_calls());

}  // namespace stickslip::record
