/// \file
/// Writers and readers of the groups of a record file (layout_*.cpp). The layout is described in
/// docs/record-file.md. All functions throw HdfError.
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

/// Bits of raw/flags.
enum ScanFlag : std::uint8_t {
  kSpike = 1U << 0U,
  kSaturated = 1U << 1U,
  kReplacedForDetection = 1U << 2U,
};

// Each takes the group /entry. The readers expect the raw data to be read first.

void write_identity(hid_t entry, const Record& record,
                    const ScanSource& scans);  ///< Title, uuid, times, metadata.
void read_identity(hid_t entry, Record& record);

/// Calibration of the column `force` beside the raw values; nothing where they are forces, or a force cannot
/// be computed: voltage without a load cell, coefficient without a sled mass.
[[nodiscard]] std::optional<daq::Calibration> force_column(const RecordHeader& header);

/// \param take_end  if any: called once the scans are written and before their flags are, so that
/// record.spikes
///        need not be known earlier; the scans are then walked twice.
/// \return SHA-256 of the raw values as the file stores them (u16, u32 or f64, little-endian), hexadecimal.
[[nodiscard]] std::string write_raw(hid_t entry, const Record& record, const ScanSource& scans,
                                    const std::function<void()>& take_end);
void read_raw(hid_t entry, Record& record);
/// The part of read_raw() without scan indices and flags. Expects read_quantity().
void read_raw_values(hid_t entry, Record& record);
/// The part of read_raw() about the board, without the scans.
void read_quantity(hid_t entry, daq::BoardInfo& board);
/// Throws unless scans, raw values and noise-free force are those of the source, to the last bit.
void verify_scans(hid_t entry, const daq::BoardInfo& board, const ScanSource& scans);

/// Second channel: columns of raw, and instrument/second. Expects both groups to be written.
void write_second(hid_t entry, const Record& record, const ScanSource& scans);
/// Reads the settings of the channel; sets header.board.second.
void read_second_channel(hid_t entry, Record& record);
void read_second(hid_t entry, Record& record);
/// Throws unless the codes of the second channel are those of the source.
void verify_second(hid_t entry, const Record& record, const ScanSource& scans);

void write_tables(hid_t entry, const Record& record);  ///< cycles, gaps, events
void read_tables(hid_t entry, Record& record);
void read_cycles(hid_t entry, Record& record);  ///< The part of read_tables() without gaps and events.
/// Throws unless they could be read.
void check_tables(hid_t entry);

/// Group of the results that are diagnostics, within the results.
inline constexpr const char* kDiagnostics = "diagnostics";

void write_results(hid_t entry, const analysis::TestResults& results);
/// \param only  names of those to be read; empty: all.
[[nodiscard]] analysis::TestResults read_results(hid_t entry, std::span<const std::string> only = {});

void write_instrument(hid_t entry, const Record& record);  ///< Also timing, sample, user, plan, self-check.
void read_instrument(hid_t entry, Record& record);

/// \param sha256  of the raw values.
void write_process(hid_t entry, const Record& record, const std::string& sha256);
void read_process(hid_t entry, Record& record);

/// Expects the raw data to be written.
void write_truth(hid_t entry, const model::TestTruth& truth, const ScanSource& scans);
[[nodiscard]] model::TestTruth read_truth(hid_t entry);
[[nodiscard]] model::TestTruth read_truth_facts(hid_t entry);  ///< The same without cycles and modes.
/// Throws unless it could be read.
void check_truth(hid_t entry);
/// The noise-free force; empty if the record has none.
[[nodiscard]] std::vector<double> read_true_coefficient(hid_t entry, std::size_t scan_count);

/// As write_raw() returns it.
[[nodiscard]] std::string sha256_of_raw(const Record& record);

}  // namespace stickslip::record
