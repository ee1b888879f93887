/// \file
/// Events that the parts of the daemon report. The implementation decides which of them are logged, and how.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include "core/base/finding.hpp"
#include "core/daq/board.hpp"
#include "core/daq/gain_change.hpp"
#include "core/daq/gap.hpp"
#include "core/daq/note.hpp"
#include "core/estimate/sampling.hpp"
#include "core/pipeline/sink.hpp"
#include "daemon/types/fleet_state.hpp"
#include "daemon/types/scan_account.hpp"

namespace stickslip::daemon {

/// Receiver of events. Thread-safe: all threads but the acquisition thread call it.
class EventReceiver {
 public:
  virtual ~EventReceiver() = default;

  virtual void board_started(const daq::BoardInfo& /*board*/, std::string_view /*scheduling*/) {}
  /// Before a session: whether the scan rate suffices for the tester.
  virtual void sampling_checked(const estimate::SamplingVerdict& /*verdict*/) {}
  /// A new calibration is kept. \param confirmed  a change of the gain that `who` confirmed.
  virtual void load_cell_calibrated(const std::filesystem::path& /*file*/, double /*gain_N_per_V*/,
                                    std::string_view /*who*/,
                                    const std::optional<daq::GainChange>& /*confirmed*/) {}
  /// Before a session: the calibration of the load cell has expired.
  virtual void calibration_expired(std::string_view /*expires*/) {}
  /// \param state  of the daemon: "board missing", "board busy" or "no permission".
  virtual void board_unavailable(std::string_view /*state*/, std::string_view /*why*/,
                                 double /*retry_in_s*/) {}
  /// \param test  number of the running test, if one runs.
  virtual void gap_seen(const daq::Gap& /*gap*/, std::optional<std::int64_t> /*test*/) {}
  /// A stall of the computer, or a step of its date. \param test  as above.
  virtual void clock_noted(const daq::Note& /*note*/, std::optional<std::int64_t> /*test*/) {}
  /// The bench stays in a state that should pass by itself. \param why  the reason, and the remedy.
  virtual void bench_stays(std::string_view /*state*/, double /*duration_s*/, std::string_view /*why*/) {}
  virtual void test_began(const pipeline::TestStart& /*start*/) {}
  virtual void test_ended(const pipeline::TestEnd& /*end*/) {}
  virtual void file_published(std::int64_t /*test*/, const std::filesystem::path& /*file*/) {}
  virtual void recording_failed(std::int64_t /*test*/, std::string_view /*why*/) {}
  /// The journal of a test was missing at its path; it was written again from the open file.
  virtual void journal_written_anew(std::int64_t /*test*/, const std::filesystem::path& /*before*/,
                                    const std::filesystem::path& /*now*/) {}
  /// Writing fails, or the record folder is away; entries wait in memory.
  virtual void storage_waits(std::string_view /*why*/) {}
  /// All waiting entries are on the disk.
  virtual void storage_resumed() {}
  /// The disk has too little room to begin a test.
  virtual void storage_short(std::string_view /*why*/) {}
  virtual void storage_has_room() {}
  /// A test begins although the disk has room for `room_s` seconds only.
  virtual void little_room(std::int64_t /*test*/, double /*room_s*/) {}
  /// At the start, once for each outdated word of the configuration, with the word to write.
  virtual void config_outdated(std::string_view /*what*/) {}
  /// At the start, once for each feature that the file system of the records lacks, with the consequence.
  virtual void record_folder_lacks(std::string_view /*what*/) {}
  /// A record was made from a journal that could not be read completely.
  virtual void record_damaged(const std::filesystem::path& /*file*/, std::string_view /*loss*/) {}
  virtual void orphan_finalised(const std::filesystem::path& /*file*/) {}
  virtual void orphan_kept(const std::filesystem::path& /*journal*/, std::string_view /*why*/) {}
  /// A record folder cannot be listed; journals in it are not recovered.
  virtual void folder_unread(const std::filesystem::path& /*folder*/, std::string_view /*why*/) {}
  /// A journal without a scan was removed.
  virtual void orphan_empty(const std::filesystem::path& /*journal*/) {}
  /// Facts that a client of the broker told are not used. \param why  with the remedy.
  virtual void facts_refused(std::string_view /*topic*/, std::string_view /*why*/) {}
  /// \param keys  of facts that no client has told for `valid_s`; they are forgotten.
  virtual void facts_expired(std::string_view /*topic*/, std::string_view /*keys*/, double /*valid_s*/) {}
  /// The connection to the broker was made or lost, or fails for another reason than before.
  virtual void fleet_changed(const FleetState& /*state*/) {}
  /// A control chart of the tester has an alarm, once for each start or restart of the chart.
  virtual void trend_alarmed(const base::Finding& /*finding*/) {}
  /// The history of the tester cannot be written, or has a line that cannot be read.
  virtual void trend_troubled(std::string_view /*why*/) {}
  virtual void control_listening(std::string_view /*socket*/) {}
  /// Threads of the daemon hang, so that the service manager will restart it. \param parts  their names,
  /// separated by commas; empty: all run again.
  virtual void hanging(std::string_view /*parts*/) {}
  /// SIGHUP came, but the changed configuration is invalid; the present one stays in use.
  virtual void reload_refused(std::string_view /*why*/) {}
  /// A changed configuration will be used when no test and no calibration is under way.
  virtual void reload_waits() {}
  virtual void stopping(std::string_view /*why*/) {}
  /// At the end of the program, when no scan is under way.
  virtual void scans_accounted(const ScanAccount& /*scans*/) {}
};

}  // namespace stickslip::daemon
