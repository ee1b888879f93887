/// \file
/// The parts of judge(): each adds what it finds to the verdict.
#pragma once

#include <filesystem>

#include "core/record/given_file.hpp"
#include "core/record/hdf.hpp"
#include "core/record/record.hpp"
#include "core/record/verdict.hpp"

namespace stickslip::record {

void judge_record(const GivenFile& given, const std::filesystem::path& path, Verdict& verdict);
void judge_journal(const std::filesystem::path& path, Verdict& verdict);

// Of a record; all but the first may throw HdfError where something is not there.

/// Reads every data set under `file` chunk by chunk, so that damage has a place.
void judge_chunks(hid_t file, Verdict& verdict);
/// Walks the scans: order, gaps, count, checksum, and what follows from the counts.
/// \param record  all but the scans, with gaps, spikes not yet.
void judge_raw(hid_t entry, const Record& record, Verdict& verdict);

// Of both.

/// Order, and the rate that they imply. \param first,end  scans of the test.
void judge_clocks(const Record& record, daq::ScanIndex first, daq::ScanIndex end, Verdict& verdict);
/// What has to be known to compute anything, and what should be.
void judge_facts(const RecordHeader& header, Verdict& verdict);
/// Lists the gaps.
void judge_gaps(const std::vector<daq::Gap>& gaps, Verdict& verdict);
/// The status and its reasons.
void judge_status(const EndRecord& end, Verdict& verdict);

}  // namespace stickslip::record
