/// \file
/// HDF5 writes and reads its files through the table of calls; what it closed is on the disk, and a read that
/// the system refused is known as such.
#pragma once

#include <filesystem>

#include "core/record/file_calls.hpp"
#include "core/record/given_file.hpp"
#include "core/record/hdf.hpp"

namespace stickslip::record {

/// Files opened with these access properties are written and read through `calls`, and synced when they are
/// closed by the descriptor that wrote them: what the disk refused late is an error of closing. For new
/// files: there is no lock. \param calls  outlives the file. Throws HdfError.
void write_through(const PropertyHandle& access, const FileCalls& calls);

/// Whether the signature of HDF5 stands where one may stand: at 0, 512, 1024, 2048 … bytes.
[[nodiscard]] bool is_hdf5(const GivenFile& file);

/// Opens a file that is there for reading, through what is open already and without a lock of HDF5's: whether
/// somebody writes it is GivenFile::share()'s to say. \param path  for messages. Throws HdfError if it is no
/// HDF5 file or its structure cannot be read.
[[nodiscard]] FileHandle open_hdf5(const GivenFile& file, const std::filesystem::path& path);

}  // namespace stickslip::record
