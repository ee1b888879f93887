/// \file
/// HDF5 writes its files through the table of calls, and what it closed is on the disk.
#pragma once

#include "core/record/file_calls.hpp"
#include "core/record/hdf.hpp"

namespace stickslip::record {

/// Files opened with these access properties are written and read through `calls`, and synced when they are
/// closed by the descriptor that wrote them: what the disk refused late is an error of closing. For new
/// files: there is no lock. \param calls  outlives the file. Throws HdfError.
void write_through(const PropertyHandle& access, const FileCalls& calls);

}  // namespace stickslip::record
