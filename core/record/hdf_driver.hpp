/// \file
/// HDF5 file driver on FileCalls: a written file is synced when it is closed, and read errors of the system
/// are distinguished from damage.
#pragma once

#include <filesystem>

#include "core/record/file_calls.hpp"
#include "core/record/given_file.hpp"
#include "core/record/hdf.hpp"

namespace stickslip::record {

/// Makes files opened with these access properties use `calls`. Closing syncs the file by the descriptor that
/// wrote it, so that a late write error is an error of closing. For new files only: it takes no lock.
/// \param calls  must outlive the file.
/// \throws HdfError.
void write_through(const PropertyHandle& access, const FileCalls& calls);

/// Whether the file has HDF5's signature at an allowed position: 0, 512, 1024, 2048 … bytes. False also if it
/// cannot be read; see GivenFile::refused().
[[nodiscard]] bool is_hdf5(const GivenFile& file);

/// Opens an existing file for reading through its open descriptor, without HDF5's lock; the handle keeps it
/// open. Take the file from open_shared(), which excludes writers and finds read errors first. On a damaged
/// file HDF5 may crash or never return.
/// \param path  must exist, since HDF5 resolves it; nothing is read from there.
/// \throws HdfError if it is not an HDF5 file or its structure cannot be read.
[[nodiscard]] FileHandle open_hdf5(const GivenFile& file, const std::filesystem::path& path);

}  // namespace stickslip::record
