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

/// Reads a record in this process. On a damaged file HDF5 may crash or never return: for files from elsewhere
/// call read_record_apart() (read_apart.hpp). A reduced file may lack results, cycles, flags, gaps, events
/// and truth; they are then absent from the record, the results with a reason.
/// \return the record with `end` and `sha256` set. Errors are one line that names the file and what is wrong:
/// kUsage if it does not exist, is no regular file, no HDF5 file, no record, of a version that is not read,
/// truncated or, as far as HDF5 notices, damaged, has data of other types, shapes or ranges, lacks the scan
/// rate or the calibration of its counts (the load cell's or the board's polynomial), or has raw values that
/// do not match their checksum; kBusy if a program is writing it; kNoPermission; kFailure if it cannot be
/// read or memory is exhausted.
[[nodiscard]] base::Result<Record> read_record(const std::filesystem::path& path,
                                               const FileCalls& calls = system_calls());

/// Reads a record whose scans (with what stands beside them: second channel, spikes, noise-free force), gaps
/// and events stay empty, as do the truth's cycles and modes. The detected cycles are read. The raw values
/// are compared with their checksum. Errors as read_record(), but damage in what is not read is not found.
/// For files from elsewhere: read_results_apart().
/// \param only  names of the results to read, the others are absent; empty: all.
[[nodiscard]] base::Result<Record> read_without_scans(const std::filesystem::path& path,
                                                      std::span<const std::string> only = {},
                                                      const FileCalls& calls = system_calls());

/// Reads a record without scans, cycles, gaps, events and truth, which stay empty; clock anchors and results
/// are read. Not verified are the checksum of the raw values, and that scan rate and polynomial are there.
/// Otherwise errors as read_record(), but damage in what is not read is not found. For files from elsewhere:
/// read_facts_apart().
[[nodiscard]] base::Result<Record> read_facts(const std::filesystem::path& path,
                                              const FileCalls& calls = system_calls());

/// Verifies a file against the record and source it was written from, piece by piece. Of `record` only the
/// quantity of the raw values and the second channel's settings are compared. Errors: kUsage if the file is
/// invalid, or if its scans differ from the source in any bit (index, raw value, code of the second channel,
/// and noise-free force if the file has a truth); kFailure if the file cannot be read, memory is exhausted or
/// the source throws std::runtime_error.
[[nodiscard]] base::Result<void> verify_record(const std::filesystem::path& path, const Record& record,
                                               const ScanSource& scans,
                                               const FileCalls& calls = system_calls());

}  // namespace stickslip::record
