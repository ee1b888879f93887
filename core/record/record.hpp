/// \file
/// Content of a record in memory, common to journals, HDF5 files and imported traces. Names and units in the
/// file: docs/record-file.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/analysis/results.hpp"
#include "core/base/long_column.hpp"
#include "core/daq/board.hpp"
#include "core/daq/calibration.hpp"
#include "core/daq/clock_anchor.hpp"
#include "core/daq/gap.hpp"
#include "core/daq/latency_histogram.hpp"
#include "core/daq/self_check_values.hpp"
#include "core/detect/cycle.hpp"
#include "core/model/tester.hpp"
#include "core/model/truth.hpp"
#include "core/record/metadata.hpp"

namespace stickslip::record {

inline constexpr std::string_view kFormat = "stickslip-record";
inline constexpr std::int64_t kFormatVersion = 3;
inline constexpr std::int64_t kOldestFormatVersion = 1;  ///< Oldest version that can be read.

/// Reason why a file of this version cannot be read, without the file's name; empty if it can.
[[nodiscard]] std::string version_refusal(std::int64_t version);

/// Completeness of a record. Gaps in the acquisition, such as overruns, do not change it.
enum class Status {
  kComplete,  ///< The test ended and everything was written.
  /// The program was stopped or killed before the end of the test, or the journal has no readable end. A part
  /// of the journal may be damaged too.
  kInterrupted,
  /// The test ended and all its scans are here; unreadable bytes after the journal's end entry were dropped.
  kRecovered,
  /// Data are missing: the disk refused scans, the board went away before the end of the test, or a part of
  /// the journal was damaged.
  kIncomplete,
};

/// Name in files and messages.
[[nodiscard]] std::string_view name(Status status) noexcept;
[[nodiscard]] std::optional<Status> status_from_name(std::string_view text) noexcept;

/// The tester, as a record knows it. An unknown value is absent, never a default.
struct TesterFacts {
  std::optional<double> sled_mass_kg;
  std::optional<double> gravity_m_per_s2;
  std::optional<double> pull_speed_m_per_s;
  std::optional<double> stiffness_N_per_m;
  std::string speed_course;  ///< model::PullSpeed::text(); empty for a constant speed.
  // As model::Transducer. Load cell and filter are each known by their frequency.
  std::optional<double> load_cell_frequency_Hz;
  std::optional<double> load_cell_damping;
  std::optional<double> anti_alias_Hz;
  std::optional<std::int64_t> anti_alias_order;

  [[nodiscard]] static TesterFacts of(const model::Tester& tester);
  /// Sets the parts that it has; the others stay.
  void set_transducer(const model::Transducer& transducer);
  /// Conversion. An absent mass or gravity becomes model::Tester's default; absent speed and stiffness stay
  /// absent, as does a course that cannot be parsed. Beside a frequency an absent damping or order becomes
  /// the typical one; without it they do not count. A transducer with a number out of range counts as not
  /// known, load cell and filter.
  [[nodiscard]] model::Tester tester() const;
  bool operator==(const TesterFacts&) const = default;
};

/// Origin of the load cell's calibration; empty or absent if unknown.
struct CalibrationFacts {
  std::string date;  ///< ISO 8601.
  std::string certificate;
  std::optional<double> gain_standard_error_N_per_V;
  std::optional<double> zero_standard_error_V;
  std::optional<double> residual_V;    ///< Standard deviation of the weights' readings about the line.
  std::optional<double> hysteresis_V;  ///< Mean residual under falling less that under rising loads.
  std::string expires;                 ///< ISO 8601; date of expiry.
  /// Gain in use before, if this one differs from it so much that it had to be confirmed (daq::GainChange).
  std::optional<double> replaced_gain_N_per_V;
  // One element for each weight, in the order of hanging; all empty if unknown.
  std::vector<double> mass_kg;
  std::vector<double> force_N;
  std::vector<double> voltage_V;
  std::vector<double> voltage_standard_error_V;
  std::vector<double> point_residual_V;  ///< Deviation from the line.
  std::vector<std::string> refused;      ///< Reason of a refusal; empty if accepted.

  bool operator==(const CalibrationFacts&) const = default;
};

/// Settings of the segmenter (pipeline::SegmenterSettings), which cut the test out of the scans. Absent if it
/// was not used, and for imported traces, which it cuts with its default settings. Coefficients are force
/// over normal load.
struct PlanFacts {
  std::optional<double> start_coefficient;
  std::optional<double> start_dwell_s;
  std::optional<double> pre_trigger_s;
  std::optional<double> end_coefficient;
  std::optional<double> end_dwell_s;  ///< SegmenterSettings::unload_dwell_s.
  std::optional<double> no_motion_dwell_s;
  /// Coefficient of the unloaded cell before the test, to which trigger and end are relative; absent if
  /// unknown.
  std::optional<double> unloaded_level{};

  bool operator==(const PlanFacts&) const = default;
};

/// The sample; a text is empty if unknown.
struct SampleFacts {
  std::string name;
  std::string grade;
  std::string direction;
  std::string side;
  std::optional<std::int64_t> replicate;  ///< From 1.
  std::optional<std::int64_t> slide;      ///< Number of the pull of this sheet, from 1.
  std::string batch;                      ///< Identifier of the batch that the test was planned in.
  std::string operator_name;
  Metadata metadata;  ///< Temperature, lot and whatever else was stated.

  bool operator==(const SampleFacts&) const = default;
};

/// Program that made the record, with its settings.
struct ProcessFacts {
  std::string program;
  std::string version;
  std::string commit;
  /// Complete text of the configuration file; of `stickslip simulate` its command line. Empty: none.
  std::string configuration;
  std::string estimator;  ///< Name of the estimator, for estimator_of(); empty: "fit".
  std::string method;     ///< Test method, method_text(); empty: the default method.
  std::string kept;       ///< Corrections left out, analysis::text_of(SkippedCorrections); empty: none.
  /// Complete text of the tester's characterisation file; empty: none.
  std::string characterisation;
  std::string realtime;    ///< Scheduling and memory locking that were granted.
  std::string simulation;  ///< Method, accuracy, extent and time of a simulation without a clock.
  // Of an imported trace, also of a table of `stickslip export`.
  std::string source_file;                  ///< Name of the file without its folder.
  std::optional<std::int64_t> source_size;  ///< Bytes.
  std::string source_sha256;                ///< Of all its bytes, hexadecimal.
  std::string source_reading;  ///< What was recognised in it and left out of it: lines for people.
  std::string source_command;  ///< Command line of the import.

  bool operator==(const ProcessFacts&) const = default;
};

/// What is known of a test before its first scan; the first entry of a journal. "Imported" below is a trace
/// of another program: an imported table of `stickslip export` has the header of its record.
struct RecordHeader {
  std::string uuid;   ///< Identifies the test for ever; JournalWriter and PatientJournal make one if empty.
  std::string title;  ///< For people.
  /// Number of the test since the start of the program, from 1; a batch that is resumed goes on with its
  /// numbers. Imported: number in a trace of several tests, else absent. Absent if simulated without a clock.
  std::optional<std::int64_t> test_number;
  /// Scan at which the force or a command began the test; absent if imported or simulated without a clock.
  std::optional<daq::ScanIndex> trigger_scan;
  /// Clock reading at the block with the trigger scan, less the delay by a stall, ns since 1970; in a replay
  /// that of the replay. Absent if unknown. Imported: time of the first scan of the test.
  std::optional<std::int64_t> start_realtime_ns;
  daq::BoardInfo board;
  std::optional<daq::LoadCell> load_cell;  ///< Required if the board gives counts.
  CalibrationFacts calibration;
  TesterFacts tester;
  SampleFacts sample;
  ProcessFacts process;
  PlanFacts plan;
  std::optional<daq::SelfCheck> self_check;  ///< Absent without idle scans before the test.
};

using daq::ClockAnchor;

/// Event at a scan of the test, as text for the user.
struct Event {
  daq::ScanIndex scan = 0;
  /// Clock since 1970 at the last scans before the event, as it stood then; realtime_at() of the scan differs
  /// where the clock was set. At the beginning RecordHeader::start_realtime_ns. In a replay that of the
  /// replay.
  std::int64_t realtime_ns = 0;
  std::string text;

  bool operator==(const Event&) const = default;
};

/// EndRecord::cause of a test during which the program died, or whose journal has no readable end.
inline constexpr std::string_view kProgramDied = "program-died";
/// Element of EndRecord::reasons that goes with Status::kInterrupted.
inline constexpr std::string_view kInterruptedWhy = "the program stopped before the end of the test";

/// What is known of a test after its last scan; the last entry of a journal.
struct EndRecord {
  Status status = Status::kComplete;
  std::vector<std::string> reasons;  ///< Why the status is not complete.
  std::string cause;                 ///< Cause of the end: pipeline::name(EndCause), or kProgramDied.
  std::optional<std::int64_t> end_realtime_ns;  ///< realtime_at() the end of the last scan.
  std::optional<double> compute_time_s;         ///< Time that the evaluation took; absent if not measured.
  std::optional<daq::LatencyHistogram> read_latency;  ///< How late the blocks were read; absent if unknown.
  /// Coefficient of the unloaded cell at the end; absent unless the test ended by unloading with a quiet
  /// force.
  std::optional<double> unloaded_level{};
  analysis::TestResults results;
  // Final; set_end() moves both into the record, in place of those noted during the test.
  base::LongColumn<detect::Cycle> cycles;
  std::vector<daq::ScanIndex> spikes;  ///< Scans replaced for the detector, rising.
  std::optional<model::TestTruth> truth;
};

/// Time of a scan, ns since 1970: start_realtime_ns plus the scans from trigger_scan on at the granted rate,
/// independent of later clock steps. Nullopt if one of the three is absent or the time is out of range.
[[nodiscard]] std::optional<std::int64_t> realtime_at(const RecordHeader& header,
                                                      daq::ScanIndex scan) noexcept;

/// Reason of a result's absence in a record of an older version.
inline constexpr std::string_view kNoSuchResultThen = "the record was made before there was this result";

/// Results of a test that could not be evaluated: all absent, regime undecided, no rung; each with `reason`.
[[nodiscard]] analysis::TestResults absent_results(const std::string& reason);

/// One test. scan and raw have equal lengths; scan rises strictly, a jump is a gap.
struct Record {
  RecordHeader header;
  std::vector<daq::ScanIndex> scan;  ///< Index of the acquisition.
  std::vector<double> raw;           ///< Of the quantity header.board.quantity.
  /// Noise-free force of each scan, a coefficient (model::TrueForce), NaN if unknown; empty if unknown for
  /// all.
  std::vector<double> true_coefficient;
  /// Code of the second channel of each scan, daq::SecondChannel::kNoCode where it did not arrive; empty if
  /// no code is known, or without header.board.second.
  std::vector<std::int32_t> second;
  std::vector<daq::ScanIndex> spikes;  ///< Scans replaced for the detector, rising.
  std::vector<daq::Gap> gaps;
  base::LongColumn<detect::Cycle> cycles;
  std::vector<ClockAnchor> anchors;
  std::vector<Event> events;
  std::optional<EndRecord> end;  ///< Absent while the test runs, and in a journal without an end.
  /// Stored checksum of the raw values, hexadecimal; set by reader.hpp and read_apart.hpp, else empty.
  std::string sha256;
};

/// Sets record.end. Its cycles and spikes replace the record's, and are then empty in record.end.
void set_end(Record& record, EndRecord end);

/// A new random UUID (RFC 4122, version 4).
[[nodiscard]] std::string make_uuid();

}  // namespace stickslip::record
