/// \file
/// The seal of a record: how many scans were committed, and a checksum of the whole file that stands inside
/// it.
///
///     { … write_seal(entry, scan_count); }   // while the file is built
///     seal_file(path);                       // after it is closed
///     check_seal(entry, file);               // any time later
///
/// HDF5 has checksums for chunks and for most of its own structures, but none for small data sets such as
/// the results, nor for the index of the chunks. process/file_sha256 is the SHA-256 of the file with these 64
/// characters taken as zero bytes: a bit that flips anywhere is found.
#pragma once

#include <filesystem>
#include <string>

#include "core/base/result.hpp"
#include "core/record/file_calls.hpp"
#include "core/record/given_file.hpp"
#include "core/record/hdf.hpp"

namespace stickslip::record {

/// Into the group process, which exists: scan_count and room for the checksum. Throws HdfError.
void write_seal(hid_t entry, std::size_t scan_count);

/// Puts the checksum into a closed file with write_seal() and syncs it. Errors: kFailure.
[[nodiscard]] base::Result<void> seal_file(const std::filesystem::path& path, const FileCalls& calls);

enum class Seal {
  kSound,
  kBroken,  ///< At least one bit of the file is not what was published.
  kOpen,    ///< The file was left before it was sealed.
  kNone,    ///< Made before there were seals.
};

/// \param file  that `entry` is in. Throws HdfError where the file cannot be read.
[[nodiscard]] Seal check_seal(hid_t entry, const GivenFile& file);

}  // namespace stickslip::record
