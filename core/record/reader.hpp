/// \file
/// Reads finished records back, whole: everything that is needed to run the test again.
#pragma once

#include <filesystem>

#include "core/base/result.hpp"
#include "core/record/file_calls.hpp"
#include "core/record/record.hpp"
#include "core/record/scan_source.hpp"

namespace stickslip::record {

/// What can be computed from the raw values (results, cycles, flags) and what tells of them (gaps, events)
/// may be missing from a file that was thinned out: it is then absent from the record as well. \return the
/// record with `end` and `sha256` set. Errors are one line that names the file and what is wrong: kUsage if
/// it is no HDF5 file, no record, another version, cut short, damaged or has data of other types or shapes;
/// kBusy, kNoPermission or kFailure if it cannot be looked at, as open_shared().
[[nodiscard]] base::Result<Record> read_record(const std::filesystem::path& path,
                                               const FileCalls& calls = system_calls());

/// Reads the whole file back, its scans piece by piece. Errors: kUsage if anything in it makes no sense or
/// its scans (index, raw value, noise-free force) are not those of the source, to the last bit; kFailure if
/// it cannot be looked at.
[[nodiscard]] base::Result<void> verify_record(const std::filesystem::path& path, const Record& record,
                                               const ScanSource& scans,
                                               const FileCalls& calls = system_calls());

}  // namespace stickslip::record
