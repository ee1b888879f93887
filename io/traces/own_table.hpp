/// \file
/// Records from tables that `stickslip export --csv` wrote (io/export_csv.hpp).
#pragma once

#include <filesystem>
#include <string>

#include "io/traces/text_file.hpp"

#include "core/base/result.hpp"
#include "core/record/record.hpp"
#include "core/record/scan_source.hpp"

namespace stickslip::traces {

/// Whether the lines above the table hold the header of a record. Errors: as TextFile.
[[nodiscard]] base::Result<bool> is_own_table(const Source& source);

/// A test of a trace.
struct ImportedTest {
  record::Record record;  ///< Everything except the scans.
  record::ColumnScans scans;
};

/// The record to the last bit, as far as the table has it: header, scans, raw values, codes of the second
/// channel, spikes, gaps, events, clock readings and the end, without results, cycles, truth and the idle
/// scans of the self-check. Its source is the file. Columns that follow from others are not read. Errors: as
/// TextFile; kUsage with place, value and a remedy if a line is not as it was exported, or if lines are
/// missing. \param scratch_folder  as of base::LongColumn, for the scans.
[[nodiscard]] base::Result<ImportedTest> read_own_table(const Source& source,
                                                        const std::filesystem::path& scratch_folder = {});

}  // namespace stickslip::traces
