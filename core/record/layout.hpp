/// \file
/// Writers and readers of the groups of a record file (layout_*.cpp). The layout is described in
/// docs/record-file.md. The functions throw HdfError; std::invalid_argument for scans and clocks out of range
/// (range_check.hpp) and for an impossible calibration (daq::Calibration); and what a ScanSource or
/// base::LongColumn throws.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "core/daq/calibration.hpp"
#include "core/record/hdf.hpp"
#include "core/record/record.hpp"
#include "core/record/scan_source.hpp"

namespace stickslip::record {

/// Bits of raw/flags. Files have kReplacedForDetection exactly where they have kSpike.
enum ScanFlag : std::uint8_t {
  kSpike = 1U << 0U,
  kSaturated = 1U << 1U,  ///< The count is 0 or maxdata; never set for other quantities.
  kReplacedForDetection = 1U << 2U,
};

// Each takes the group /entry. The caller sets record.end before, and calls read_quantity() before the other
// readers.

void write_identity(hid_t entry, const Record& record,
                    const ScanSource& scans);  ///< Title, uuid, numbers, times, metadata.
void read_identity(hid_t entry, Record& record);

/// Calibration of the column `force` beside the raw values. Nullopt if they are forces themselves, or if no
/// force can be computed: counts or voltages without a load cell, coefficients without a sled mass.
[[nodiscard]] std::optional<daq::Calibration> force_column(const RecordHeader& header);

/// Writes the group raw: times, scan indices, raw values, forces if force_column() has a value, and flags.
/// \param take_end  if any: called between the scans and their flags, to set record.spikes. The source
///        is then read twice.
/// \return SHA-256 of the raw values as the file stores them (u16, u32 or f64, little-endian), hexadecimal.
[[nodiscard]] std::string write_raw(hid_t entry, const Record& record, const ScanSource& scans,
                                    const std::function<void()>& take_end);
/// Reads quantity, scan indices, raw values and spikes; a file without flags has no spikes. Throws HdfError
/// if the scans do not rise strictly or a raw value is not finite.
void read_raw(hid_t entry, Record& record);
/// Reads record.raw alone. Throws HdfError if a value is not finite.
void read_raw_values(hid_t entry, Record& record);
/// Reads into board.quantity which quantity the raw values are.
void read_quantity(hid_t entry, daq::BoardInfo& board);
/// Throws unless scan indices and raw values are those of the source, to the last bit. So must be the
/// noise-free force, if the source has it and the file has the group truth.
void verify_scans(hid_t entry, const daq::BoardInfo& board, const ScanSource& scans);

/// Writes the second channel, if record.header.board has one: instrument/second, and columns of raw if
/// `scans` have codes. Expects the groups raw and instrument to be written.
void write_second(hid_t entry, const Record& record, const ScanSource& scans);
/// Reads the settings of the second channel into header.board.second, which stays absent if there is none.
void read_second_channel(hid_t entry, Record& record);
/// Reads the codes of the second channel, if there are any; after read_second_channel() and read_raw().
void read_second(hid_t entry, Record& record);
/// Throws unless the codes of the second channel are those of the source. Compares nothing if the source has
/// none or record.header.board.second is absent.
void verify_second(hid_t entry, const Record& record, const ScanSource& scans);

void write_tables(hid_t entry, const Record& record);  ///< cycles, gaps, events
void read_tables(hid_t entry, Record& record);         ///< A table that the file lacks is empty.
void read_cycles(hid_t entry, Record& record);         ///< The part of read_tables() without gaps and events.
/// Throws where read_tables() would; keeps no cycles in memory.
void check_tables(hid_t entry);

/// Group of the results that are diagnostics, within the results.
inline constexpr const char* kDiagnostics = "diagnostics";

void write_results(hid_t entry, const analysis::TestResults& results);
/// Regime, rung, misfit_place and findings are always read. In a file without results all are absent, with
/// the reason.
/// \param only  names of the estimates to read, the others are absent; empty: all.
[[nodiscard]] analysis::TestResults read_results(hid_t entry, std::span<const std::string> only = {});

void write_instrument(hid_t entry, const Record& record);  ///< Also timing, sample, user, plan, self-check.
void read_instrument(hid_t entry, Record& record);

/// \param sha256  of the raw values, from write_raw().
void write_process(hid_t entry, const Record& record, const std::string& sha256);
/// Reads header.process, sha256, and of `end` status, reasons, cause, unloaded level and compute time.
void read_process(hid_t entry, Record& record);

/// Writes the group truth, with the noise-free force of `scans` if they have it. Expects raw to be written.
void write_truth(hid_t entry, const model::TestTruth& truth, const ScanSource& scans);
// These read the group truth, and throw if it is missing.
[[nodiscard]] model::TestTruth read_truth(hid_t entry);
[[nodiscard]] model::TestTruth read_truth_facts(hid_t entry);  ///< read_truth() without cycles and modes.
/// Throws where read_truth() would; keeps no cycles and modes in memory.
void check_truth(hid_t entry);
/// The noise-free force of each scan, a coefficient; empty if the file has none.
/// \param scan_count  required number of values.
[[nodiscard]] std::vector<double> read_true_coefficient(hid_t entry, std::size_t scan_count);

/// SHA-256 of record.raw, as write_raw() returns it.
[[nodiscard]] std::string sha256_of_raw(const Record& record);

}  // namespace stickslip::record
