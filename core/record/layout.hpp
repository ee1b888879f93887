/// \file
/// The groups of a record file, each with its way in and its way back (layout_*.cpp). The layout
/// is described in docs/record-file.md. All functions throw HdfError.
#pragma once

#include "core/record/hdf.hpp"
#include "core/record/record.hpp"

namespace stickslip::record {

// Each takes the group /entry. The readers expect the raw data to be read first.

void write_identity(hid_t entry, const Record& record);  ///< Title, uuid, times.
void read_identity(hid_t entry, Record& record);

void write_raw(hid_t entry, const Record& record);
void read_raw(hid_t entry, Record& record);

void write_tables(hid_t entry, const Record& record);  ///< cycles, gaps, events
void read_tables(hid_t entry, Record& record);

void write_results(hid_t entry, const friction::TestResults& results);
[[nodiscard]] friction::TestResults read_results(hid_t entry);

void write_instrument(hid_t entry, const Record& record);  ///< instrument, timing, sample, user
void read_instrument(hid_t entry, Record& record);

void write_process(hid_t entry, const Record& record);
void read_process(hid_t entry, Record& record);

void write_truth(hid_t entry, const friction::TestTruth& truth);
[[nodiscard]] friction::TestTruth read_truth(hid_t entry);

/// SHA-256 of the raw values as the file stores them (u16, u32 or f64, little-endian), hexadecimal.
[[nodiscard]] std::string sha256_of_raw(const Record& record);

}  // namespace stickslip::record
