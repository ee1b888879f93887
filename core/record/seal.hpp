/// \file
/// The seal of a record: the number of scans, and a checksum of the whole file, stored inside it.
///
///     { … write_seal(entry, scan_count); }   // while the file is built
///     seal_file(path, calls);                // after it is closed
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

/// Writes scan_count and a placeholder for the checksum into the group process, which must exist. Throws
/// HdfError.
void write_seal(hid_t entry, std::size_t scan_count);

/// Writes the checksum into a closed file that has a placeholder from write_seal(), and syncs it. Errors:
/// kFailure.
[[nodiscard]] base::Result<void> seal_file(const std::filesystem::path& path, const FileCalls& calls);

/// State of a file's seal.
enum class Seal {
  kSound,   ///< The checksum matches the file.
  kBroken,  ///< At least one bit of the file is not what was published.
  kOpen,    ///< The file was left before it was sealed.
  kNone,    ///< Made by a version without seals.
};

/// Compares the whole file with the stored checksum; the number of scans is not checked.
/// \param file  that contains `entry`.
/// \throws HdfError if the file cannot be read, or the seal has another form than write_seal() gives it.
[[nodiscard]] Seal check_seal(hid_t entry, const GivenFile& file);

}  // namespace stickslip::record
