/// \file
/// The parts of judge(). Each adds its findings to the verdict.
#pragma once

#include <filesystem>

#include "core/record/given_file.hpp"
#include "core/record/hdf.hpp"
#include "core/record/record.hpp"
#include "core/record/verdict.hpp"

namespace stickslip::record {

void judge_record(const GivenFile& given, const std::filesystem::path& path, Verdict& verdict);
void judge_journal(const std::filesystem::path& path, Verdict& verdict);

// For records. All but the first may throw HdfError if an object is missing.

/// Reads every data set under `file` chunk by chunk, to locate damage.
void judge_chunks(hid_t file, Verdict& verdict);
/// Checks the scans: order, gaps, number, checksum, and the columns computed from the counts.
/// \param record  everything except scans and spikes.
void judge_raw(hid_t entry, const Record& record, Verdict& verdict);

// For records and journals.

/// Checks the order of the clock anchors and the scan rate that they imply.
/// \param first,end  scans of the test.
void judge_clocks(const Record& record, daq::ScanIndex first, daq::ScanIndex end, Verdict& verdict);
/// Checks that the header contains the required and the recommended facts.
void judge_facts(const RecordHeader& header, Verdict& verdict);
/// Lists the gaps.
void judge_gaps(const std::vector<daq::Gap>& gaps, Verdict& verdict);
/// Adds the status with its reasons.
void judge_status(const EndRecord& end, Verdict& verdict);

}  // namespace stickslip::record
