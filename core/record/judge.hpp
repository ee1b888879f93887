/// \file
/// The parts of judge(). Each adds its findings to the verdict.
#pragma once

#include <filesystem>

#include "core/record/given_file.hpp"
#include "core/record/hdf.hpp"
#include "core/record/record.hpp"
#include "core/record/verdict.hpp"

namespace stickslip::record {

/// Judges a file that is no journal, whether it is HDF5 or not: fills in the verdict except the judgement.
/// \param given  open, locked and loaded. \param path  its path; its extension may tell that it was a record.
/// \throws std::bad_alloc
void judge_record(const GivenFile& given, const std::filesystem::path& path, Verdict& verdict);
/// Judges a journal, read by system_calls(): fills in the verdict except the judgement, the checksums and
/// scans_committed.
void judge_journal(const std::filesystem::path& path, Verdict& verdict);

// For records.

/// Reads every data set under `file` to locate damage: those in chunks chunk by chunk, others as a whole. It
/// skips data sets whose elements have a variable length, be they texts or arrays. A chunk that is not stored
/// is damage, and so is what would be more than 256 MiB to read at once. After 100 damaged chunks of a data
/// set the rest of it is not read.
void judge_chunks(hid_t file, Verdict& verdict);
/// Judges the rows of raw: order of the scans, jumps without a gap, values that the board cannot give, and
/// what is computed from other columns (time, force, flag of saturation, second channel). If there is a scan,
/// calls judge_clocks(): call judge_status() before. Sets scans_present and sha256_found, and compares
/// neither. Reports each kind of fault once, at its first row.
/// \param record  everything except scans and spikes.
/// \throws std::exception if a column is missing, unreadable or of another length, or an index out of range.
/// Only codes of the second channel may be missing, and forces unless raw has counts and there is a load
/// cell.
void judge_raw(hid_t entry, const Record& record, Verdict& verdict);

// For records and journals.

/// Judges the clock anchors. Damage: scans or monotonic times that do not rise, or an anchor outside a
/// complete test. Incomplete: a scan rate that differs from the granted one by more than 1 % plus 5 standard
/// errors. A note: an anchor outside any other test, the date was set by more than 1 s, or the scans were
/// read too late to tell the rate. Rate and date are judged only if the verdict has no damage: the date from
/// 2 anchors on, the rate from RateFit::kFewestAnchors on. Call judge_status() before.
/// \param first,end  scans of the test: [first, end).
void judge_clocks(const Record& record, daq::ScanIndex first, daq::ScanIndex end, Verdict& verdict);
/// Judges the facts of the header. Damage: no scan rate, no UUID, counts or volts without load cell, counts
/// without polynomial. Incomplete: a record of stickslipd without its configuration. A note: a Comedi board
/// without date of the load cell's calibration.
void judge_facts(const RecordHeader& header, Verdict& verdict);
/// Sets the gaps of the verdict; each makes it incomplete.
void judge_gaps(const std::vector<daq::Gap>& gaps, Verdict& verdict);
/// Sets the status of the verdict; any but complete makes it incomplete, with the reasons.
void judge_status(const EndRecord& end, Verdict& verdict);

}  // namespace stickslip::record
